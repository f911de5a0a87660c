"""Ways by planners of OMPL: proven, seeded, ended by iterations."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import InCollision, InvalidRequest, load_robot
from tests.moves.cells import moving, nearest_bodies, post, turned, window

pytest.importorskip("ompl", reason="the extra ikplan[ompl]")

ENGINES = ["ompl:RRTConnect", "ompl:AORRTC", "ompl:BITstar"]


def around_a_post(**ik: Any) -> dict[str, Any]:
    robot = load_robot("ur5")
    segment = {"type": "move", "q": turned(robot, 1.6).tolist()}
    return moving("ur5", [segment], scene={"obstacles": [post(robot)]}, ik=ik)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_way_of_ompl_is_proven_and_the_same_every_time(engine: str) -> None:
    request = around_a_post(move_engine=engine, effort=300)
    plan, again = ikplan.plan(request), ikplan.plan(request)
    assert plan.q.tobytes() == again.q.tobytes()
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert nearest_bodies(plan, request["scene"]) > 0.0
    (report,) = plan.stats.moves
    assert 0 < report.samples <= 300
    assert report.least_length <= report.length <= report.found_length
    other = ikplan.plan(around_a_post(move_engine=engine, effort=300, seed=1))
    assert other.q.tobytes() != plan.q.tobytes()


def test_the_engine_is_part_of_the_id_and_the_default_is_not() -> None:
    requests = [around_a_post(), around_a_post(move_engine="ikplan")]
    requests += [around_a_post(move_engine=engine) for engine in ENGINES]
    ids = [ikplan.PlanRequest.model_validate(request).content_hash() for request in requests]
    assert ids[0] == ids[1]
    assert len(set(ids)) == 4


def test_no_way_within_its_iterations_is_not_called_impossible() -> None:
    robot = load_robot("ur5")
    segment = {"type": "move", "q": turned(robot, 1.4).tolist()}
    scene = {"obstacles": window(robot, opening=0.3)}
    ik = {"move_engine": "ompl:RRTConnect", "effort": 1}
    start = turned(robot, 0.2).tolist()
    with pytest.raises(InCollision, match="does not prove") as caught:
        ikplan.plan(moving("ur5", [segment], scene=scene, ik=ik, start=start))
    assert not caught.value.proven


def test_regions_and_engines_that_there_are_not_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(InvalidRequest, match="move_engine"):
        ikplan.plan(around_a_post(move_engine="ompl:PRM"))
    request = around_a_post(move_engine="ompl:RRTConnect")
    box = {"frame": {"position": np.zeros(3).tolist()}, "size": [9.0, 9.0, 9.0]}
    request["path"]["segments"][0]["within"] = {"box": box}
    with pytest.raises(InvalidRequest, match="region"):
        ikplan.plan(request)
    monkeypatch.setitem(sys.modules, "ompl.geometric", None)
    with pytest.raises(InvalidRequest, match=r"ikplan\[ompl\]") as caught:
        ikplan.plan(around_a_post(move_engine="ompl:RRTConnect"))
    assert caught.value.field == "ik.move_engine"
