"""Small URDFs for tests, written out so that one thing at a time can be made wrong."""

from __future__ import annotations

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'


def joint(
    name: str,
    parent: str,
    child: str,
    *,
    kind: str = "revolute",
    axis: str = '<axis xyz="0 0 1"/>',
    limit: str = LIMIT,
    origin: str = '<origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>',
    more: str = "",
) -> str:
    return (
        f'<joint name="{name}" type="{kind}">{origin}<parent link="{parent}"/>'
        f'<child link="{child}"/>{axis}{limit}{more}</joint>'
    )


def urdf(*joints: str, links: str = "a b c") -> str:
    bodies = "".join(f'<link name="{link}"/>' for link in links.split())
    return f'<robot name="test">{bodies}{"".join(joints)}</robot>'


def two_joints(**second: str) -> str:
    """Links a -> b -> c; the keywords change the second joint, ``j2``."""
    return urdf(joint("j1", "a", "b"), joint("j2", "b", "c", **second))


def long_chain(joints: int, kind: str = "revolute") -> str:
    return urdf(
        *(joint(f"j{i}", f"l{i}", f"l{i + 1}", kind=kind) for i in range(joints)),
        links=" ".join(f"l{i}" for i in range(joints + 1)),
    )
