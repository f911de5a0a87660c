"""What is warmed up at the start of the service, nobody has to wait for afterwards."""

import subprocess
import sys

# In a process of its own: other tests of this one have compiled what they needed.
SCRIPT = """
import gc, json
from numba.core.dispatcher import Dispatcher
from ikplan import IkplanError
from ikplan_api.workers.tasks import TaskInput, run_task, warm_up

def compiled():
    kernels = [k for k in gc.get_objects() if isinstance(k, Dispatcher)]
    return {(k.py_func.__qualname__, str(s)) for k in kernels for s in k.signatures}

warm_up()
before = compiled()
assert before
point = {"position": [0.6, 0.0, 0.4]}
full = {**point, "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]}
start = [0.0, 0.52, 0.0, -1.57, 0.0, 1.05, 0.0]
for extra in (
    {}, {"start": start}, {"start": "free"}, {"tool": {"position": [0.0, 0.0, 0.1]}},
    {"ik": {"method": "lm"}}, {"ik": {"refine": False}}, {"ik": {"params": {"decouple": True}}},
    {"robot": "kinova_j2s6s200"}, {"robot": "dobot_magician"}, {"robot": "tiago"},
):
    for waypoints in ([point, point], [full, full], [full, point]):
        request = {"robot": "iiwa14", "path": {"waypoints": waypoints}, **extra}
        try:
            run_task("plan", TaskInput(json.dumps(request).encode()))
        except IkplanError:
            pass
def ask(kind, **request):
    try:
        run_task(kind, TaskInput(json.dumps(request).encode()))
    except IkplanError as error:
        return error.slug
    return "made"

# Checked for contact: clear of it, refused, proven, with what is carried.
def scene(y, size):
    shape = {"type": "box", "size": size}
    return {"obstacles": [{"name": "box", "shape": shape, "position": [0.6, y, 0.4]}]}

far, wall, block = scene(0.6, [0.1] * 3), scene(0.1, [0.9, 0.02, 0.9]), scene(0.2, [0.3] * 3)
part = {"name": "part", "shape": {"type": "sphere", "radius": 0.02}, "last_segment": 0}
ends = [[0.6, 0.0, 0.4], [0.6, 0.2, 0.4]]
seen = []
for robot in ("ur5", "panda"):
    for how in ("line", "joint"):
        path = {"waypoints": [{"position": p} for p in ends], "interpolation": how}
        for around in (far, {**far, "attached": [part]}, wall, block):
            request = {"robot": robot, "start": "free", "path": path, "scene": around}
            seen.append(ask("plan", **request, sampling={"form": "polynomial"}))
    for around in (far, block):
        seen.append(ask("ik", robot=robot, position=ends[1], scene=around))
        q = [0.2, -0.7, 0.1, -1.5, 0.1, 1.2, 0.1][: 6 if robot == "ur5" else 7]
        rows = [q, [v + 0.2 for v in q]]
        seen.append(ask("time", robot=robot, waypoints=rows, scene=around))
assert {"made", "in-collision"} <= set(seen), seen
for name, signature in sorted(compiled() - before):
    print(name, signature)
"""


def test_after_the_warm_up_no_request_waits_for_a_compiler() -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True, timeout=300
    )
    assert done.stdout == ""
