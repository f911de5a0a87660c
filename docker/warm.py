"""Compile every kernel of the service and check that a plan can be made."""

from ikplan._jit import cache_folder
from ikplan.ik.registry import solvers
from ikplan_api.tasks import warm_up

if __name__ == "__main__":
    warm_up([solver.name for solver in solvers()])
    kernels = len(list(cache_folder().rglob("*.nbc")))
    print(f"{kernels} kernels in {cache_folder()}")
