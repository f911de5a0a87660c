"""Serial chains of every kind of joint, written as URDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pinocchio as pin
from hypothesis import strategies as st

from ikplan.robots import Robot, robot_from_urdf

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Joint:
    """One joint: where it is in the link before, and what it moves along or about."""

    kind: str
    axis: Triple = (0.0, 0.0, 1.0)
    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)
    lower: float = -2.9
    upper: float = 2.9


def _text(values: Triple) -> str:
    return " ".join(repr(v) for v in values)


def urdf_of(joints: Sequence[Joint], base: Joint, tip: Joint) -> str:
    """The URDF of a chain between a fixed ``base`` joint and a fixed ``tip`` joint."""
    joints = [base, *joints, tip]
    links = [f'<link name="l{i}"/>' for i in range(len(joints) + 1)]
    rows = []
    for i, j in enumerate(joints):
        limit = f'<limit lower="{j.lower!r}" upper="{j.upper!r}" velocity="1" effort="1"/>'
        rows.append(
            f'<joint name="j{i}" type="{j.kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<origin xyz="{_text(j.xyz)}" rpy="{_text(j.rpy)}"/><axis xyz="{_text(j.axis)}"/>'
            f"{'' if j.kind == 'fixed' else limit}</joint>"
        )
    return f'<robot name="synthetic">{"".join(links)}{"".join(rows)}</robot>'


def robot_of(
    joints: Sequence[Joint], base: Joint = Joint("fixed"), tip: Joint = Joint("fixed")
) -> Robot:
    """The chain as a robot, from the first link to the last."""
    return robot_from_urdf(urdf_of(joints, base, tip))


def pinocchio_pose(document: str, robot: Robot, q: Sequence[float]) -> pin.SE3:
    """Pose of the last link in the first by Pinocchio's own reading of the URDF."""
    model = pin.buildModelFromXML(document)
    data = model.createData()
    pin.framesForwardKinematics(model, data, robot.configuration(q))
    return data.oMf[model.getFrameId(robot.base_frame)].actInv(
        data.oMf[model.getFrameId(robot.tip_frame)]
    )


_number = st.floats(-1.0, 1.0, allow_subnormal=False)
_triple = st.tuples(_number, _number, _number)
_axis = st.one_of(
    st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)]),
    _triple.filter(lambda a: sum(v * v for v in a) > 1e-2),
)
_turn = st.tuples(*[st.floats(-3.2, 3.2, allow_subnormal=False)] * 3)


def placed(kinds: st.SearchStrategy[str]) -> st.SearchStrategy[Joint]:
    """Joints of these kinds at arbitrary places, about arbitrary axes."""
    return st.builds(Joint, kinds, _axis, _triple, _turn)


moving = st.sampled_from(["revolute", "continuous", "prismatic"])
chains = st.tuples(
    st.lists(placed(moving), min_size=1, max_size=8),
    placed(st.just("fixed")),
    placed(st.just("fixed")),
)
