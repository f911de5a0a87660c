"""Couplings: mimic joints on a chain, and controllers that count a joint together with another.

The controller of a FANUC counts J3 from the horizontal, so that its J3 is the description's joint
less J2; the coupling is ``{"J3": {"J2": 1, "J3": 1}}``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ikplan.errors import InvalidRobot, near_names
from ikplan.robots.description import Coupling
from ikplan.robots.urdf.tree import Joint

__all__ = ["given_coupling", "mimic_coupling", "user_joints"]


def user_joints(chain: Sequence[Joint]) -> list[Joint]:
    """Return the joints of a chain that are moved by themselves."""
    return [joint for joint in chain if joint.mimic is None]


def mimic_coupling(robot: str, chain: Sequence[Joint]) -> Coupling | None:
    """Return the coupling of a chain's mimic joints, or None where there are none.

    Raises:
        InvalidRobot: A joint mimics one that is not on the chain, or itself by way of others.
    """
    if all(joint.mimic is None for joint in chain):
        return None
    users = [joint.name for joint in user_joints(chain)]
    by_name = {joint.name: joint for joint in chain}
    rows, offsets = [], []
    for joint in chain:
        factor, offset, at = 1.0, 0.0, joint
        for _ in chain:
            if at.mimic is None:
                break
            leader = by_name.get(at.mimic)
            if leader is None:
                raise InvalidRobot(
                    f"{robot}: joint {joint.name!r} on the chain mimics {at.mimic!r}, which is not "
                    f"on it; choose base and tip so that both are, or neither; on the chain are "
                    f"{', '.join(users)}",
                    robot=robot,
                    joint=joint.name,
                    value=at.mimic,
                    valid=users,
                )
            offset += factor * at.offset
            factor *= at.multiplier
            at = leader
        if at.mimic is not None:
            raise InvalidRobot(
                f"{robot}: joint {joint.name!r} mimics itself by way of {at.mimic!r}",
                robot=robot,
                joint=joint.name,
                value=at.mimic,
            )
        rows.append(tuple(factor if name == at.name else 0.0 for name in users))
        offsets.append(offset)
    return Coupling(tuple(by_name), tuple(rows), tuple(offsets))


def given_coupling(
    robot: str, chain: Sequence[Joint], given: Mapping[str, Mapping[str, float]]
) -> Coupling:
    """Return a coupling that is given by the joints it changes.

    Args:
        robot: Name of the robot, for messages.
        chain: The joints that move, from base to tip.
        given: For joints of the description, their value as a sum of factors times the values of
            the controller's joints; the others follow their own names, or what they mimic.

    Raises:
        InvalidRobot: A name is none of a joint on the chain.
    """
    users = [joint.name for joint in user_joints(chain)]
    plain = mimic_coupling(robot, chain)
    names = [joint.name for joint in chain]
    rows = [tuple(float(n == u) for u in users) for n in names]
    offsets = [0.0] * len(names)
    if plain is not None:
        rows, offsets = list(plain.matrix), list(plain.offset)
    for joint, factors in given.items():
        _require(robot, joint, names)
        for each in factors:
            _require(robot, each, users)
        rows[names.index(joint)] = tuple(float(factors.get(u, 0.0)) for u in users)
    return Coupling(tuple(names), tuple(rows), tuple(offsets))


def _require(robot: str, name: str, names: Sequence[str]) -> None:
    if name not in names:
        near = near_names(name, names)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise InvalidRobot(
            f"{robot}: coupling: no joint {name!r} on the chain{hint}; there are "
            f"{', '.join(names)}",
            robot=robot,
            joint=name,
            valid=list(names),
        )
