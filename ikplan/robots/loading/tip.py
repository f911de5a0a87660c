"""The tip of an arm by rule, so that a description with one arm needs no question.

The walk goes from the base along joints that move. An arm ends where nothing moves any more, or
where a gripper begins: joints that fork into short branches, mimic joints, or joints that are named
for fingers. Where one arm is found, its tip is the frame fixed to its last body that is named for
a tool; where there are several, the error lists them with their joint counts.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ikplan.errors import InvalidRobot
from ikplan.robots.urdf.tree import MOVABLE, Joint, KinematicTree

__all__ = ["ArmEnd", "arm_ends", "pick_chain"]

TIP_NAMES = (
    "tool0", "tcp", "hand_tcp", "tool", "tool_frame", "tool_link", "ee_link", "ee", "ee_frame",
    "end_effector", "end_effector_link", "eef", "flange", "grasp", "gripper_base", "gripper",
)  # fmt: skip
"""Names of frames that tools are meant to be fixed to, the most usual first."""

_ARM, _SHORT_ARM = 4, 3
"""An end with so many joints is an arm; one with the smaller number, where none has more."""
_BEHIND, _FINGER = 3, 2
"""So many joints lie before a gripper; so many at most in each of its branches."""
_HAND_DEPTH = 8
"""So many joints at most lie in a finger of a hand, coupled ones of tendons included."""
_HAND = re.compile(
    r"finger|thumb|jaw|claw|knuckle|gripper|grasp|pinch|hand_|_hand|suction|camera|_pan\b|tilt",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class ArmEnd:
    """Where an arm ends.

    Attributes:
        link: The body after its last joint.
        joints: How many joints lie between the base and it.
        frames: Links fixed to that body, itself first.
    """

    link: str
    joints: int
    frames: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.link} ({self.joints} joint{'' if self.joints == 1 else 's'})"


class _Walk:
    """The tree as bodies: links that are fixed to each other, and the joints that leave them."""

    def __init__(self, tree: KinematicTree) -> None:
        self.below: dict[str, list[Joint]] = {name: [] for name in tree.link_names}
        for joint in tree.joints:
            self.below[joint.parent].append(joint)
        self.depth = self._depths(tree)

    def _depths(self, tree: KinematicTree) -> dict[str, int]:
        """Most joints on any way down from each link; a mimic moves, but counts for none."""
        order, pending = [], [tree.root]
        while pending:
            link = pending.pop()
            order.append(link)
            pending += [joint.child for joint in self.below[link]]
        depth: dict[str, int] = {}
        for link in reversed(order):
            depth[link] = max(
                (depth[j.child] + (_moves(j) and j.mimic is None) for j in self.below[link]),
                default=0,
            )
        return depth

    def body(self, link: str) -> tuple[list[str], list[Joint]]:
        """Links fixed to a link, in the order of the walk, and the joints that move below them."""
        links, leaving, pending = [], [], [link]
        while pending:
            link = pending.pop(0)
            links.append(link)
            for joint in self.below[link]:
                if joint.kind == "fixed":
                    pending.append(joint.child)
                else:
                    leaving.append(joint)
        return links, leaving

    def ends(self, base: str) -> Iterator[ArmEnd]:
        pending = [(base, 0)]
        while pending:
            link, behind = pending.pop(0)
            links, leaving = self.body(link)
            onward = [j for j in leaving if j.mimic is None or not _is_finger(j)]
            if not leaving or self._is_gripper(leaving, behind):
                if behind:
                    yield ArmEnd(link, behind, tuple(links))
                continue
            for joint in onward or leaving:
                pending.append((joint.child, behind + (_moves(joint) and joint.mimic is None)))

    def _is_gripper(self, leaving: list[Joint], behind: int) -> bool:
        """Whether what moves beyond a body is a gripper or a hand, not more of the arm."""
        if behind < _BEHIND:
            return False
        ahead = [self.depth[j.child] + (_moves(j) and j.mimic is None) for j in leaving]
        if len(leaving) == 1:
            # The last joint of a wrist may carry a link that is named for the gripper.
            return ahead[0] <= _FINGER and _HAND.search(leaving[0].name) is not None
        named = all(_is_finger(j) for j in leaving)
        return max(ahead) <= _FINGER or (named and max(ahead) <= _HAND_DEPTH)


def _moves(joint: Joint) -> bool:
    return joint.kind in MOVABLE


def _is_finger(joint: Joint) -> bool:
    return bool(_HAND.search(joint.name) or _HAND.search(joint.child))


def arm_ends(tree: KinematicTree, base: str) -> list[ArmEnd]:
    """Return where arms end below a base: with four joints or more, else with the most there are.

    Args:
        tree: The description.
        base: Link to begin at.
    """
    place = {name: i for i, name in enumerate(tree.link_names)}
    ends = sorted(_Walk(tree).ends(base), key=lambda end: place[end.link])
    for least in (_ARM, _SHORT_ARM):
        arms = [end for end in ends if end.joints >= least]
        if arms:
            return arms
    return ends


def pick_chain(tree: KinematicTree, base: str | None) -> tuple[str, str, list[str]]:
    """Return base and tip of the one arm of a description, and what was assumed.

    Args:
        tree: The description.
        base: Base link; None: the root, or the link below the last joint that floats or slides in
            a plane.

    Raises:
        InvalidRobot: There are several arms; they are listed with their joint counts.
    """
    start = tree.root if base is None else tree.require_link(base, "base")
    leaves, ends = tree.leaves(start), arm_ends(tree, start)
    if not ends:
        tip = leaves[0]
    elif len(ends) > 1:
        raise InvalidRobot(
            f"{tree.name}: name the tip link; {start!r} leads to {len(ends)} ends: "
            + ", ".join(str(end) for end in ends[:40]),
            robot=tree.name,
            valid=[end.link for end in ends],
        )
    else:
        tip = leaves[0] if leaves == [*ends[0].frames][-1:] else _tool_frame(ends[0])
    notes = []
    if len(leaves) > 1:
        notes.append(f"tip: {tip}, by rule: the end of the one arm below {start}")
    chain = tree.chain(start, tip)
    free = [j for j in chain if j.kind in ("floating", "planar")]
    if free and base is None and any(_moves(j) for j in chain[chain.index(free[-1]) :]):
        start = free[-1].child
        notes.append(f"base: {start}, below the {free[-1].kind} joint {free[-1].name}")
    return start, tip, notes


def _tool_frame(end: ArmEnd) -> str:
    """The frame of an end that is named for a tool; else its body."""
    for name in TIP_NAMES:
        for frame in end.frames:
            plain = frame.lower().replace("-", "_")
            if plain == name or plain.endswith(("_" + name, "/" + name)):
                return frame
    return end.link
