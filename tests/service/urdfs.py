"""URDFs for uploads: an arm that plans, and what an attacker sends."""

from __future__ import annotations

LIMIT = '<limit lower="-2.5" upper="2.5" velocity="2" effort="50"/>'


def chain(joints: int) -> str:
    """An arm of joints about z and y in turn, 0.2 m apart; link ``l<n>`` is the last."""
    parts = ['<robot name="arm"><link name="l0"/>']
    for i in range(joints):
        axis = "0 0 1" if i % 2 == 0 else "0 1 0"
        parts.append(
            f'<link name="l{i + 1}"/><joint name="j{i + 1}" type="revolute">'
            f'<origin xyz="0 0 0.2"/><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<axis xyz="{axis}"/>{LIMIT}</joint>'
        )
    return "".join([*parts, "</robot>"])


ARM = chain(6)


def with_mesh(uri: str) -> str:
    visual = f'<visual><geometry><mesh filename="{uri}"/></geometry></visual>'
    return ARM.replace('<link name="l3"/>', f'<link name="l3">{visual}</link>')


_BOMB = "".join(f'<!ENTITY b{i} "{f"&b{i - 1};" * 10 if i else "bomb" * 10}">' for i in range(10))

HOSTILE: dict[str, tuple[str, str]] = {
    "entity bomb": (f"<!DOCTYPE robot [{_BOMB}]><robot name='&b9;'/>", "document type definition"),
    "quadratic bomb": (
        f'<!DOCTYPE robot [<!ENTITY a "{"x" * 50_000}">]><robot name="{"&a;" * 50_000}"/>',
        "document type definition",
    ),
    "external entity": (
        '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="&x;"/>',
        "document type definition",
    ),
    "external DTD": (
        '<!DOCTYPE robot SYSTEM "http://127.0.0.1:1/x.dtd"><robot/>',
        "document type definition",
    ),
    "300 joints": (chain(300), "300 movable joints; at most 64"),
    "10,000 deep": (
        "<robot>" + "<link>" * 10_000 + "</link>" * 10_000 + "</robot>",
        "nested more than 32 deep",
    ),
    "10,000 deep and never closed": ("<robot>" + "<a>" * 10_000, "nested more than 32 deep"),
    "60,000 elements": ("<robot>" + "<a/>" * 60_000 + "</robot>", "more than 50000 XML elements"),
    "a loop": (
        ARM.replace('<link name="l0"/>', "").replace('parent link="l0"', 'parent link="l6"'),
        "loop",
    ),
    "a megabyte for a number": (
        ARM.replace('lower="-2.5"', f'lower="{"1" * 900_000}"', 1),
        "lower",
    ),
    "lower above upper": (ARM.replace('lower="-2.5"', 'lower="3"'), "joint 'j1': the lower"),
    "velocity of zero": (ARM.replace('velocity="2"', 'velocity="0"'), "joint 'j1': the velocity"),
    "velocity of nan": (ARM.replace('velocity="2"', 'velocity="nan"'), "velocity of joint 'j1'"),
    "zero axis": (ARM.replace("0 1 0", "0 0 0"), "joint 'j2' has a zero axis"),
    "no limits": (ARM.replace(LIMIT, ""), "joint 'j1' has no velocity limit"),
}
"""A name, what is sent, and words of the reason for the refusal."""

DROPPED_MESHES: dict[str, tuple[str, str]] = {
    "file mesh": (with_mesh("file:///etc/passwd"), "not a scheme for meshes"),
    "absolute mesh": (with_mesh("/etc/passwd"), "an absolute path"),
    "climbing mesh": (with_mesh("package://x/../../etc/passwd"), "climbs out"),
    "climbing package": (with_mesh("package://../etc/passwd"), "climbs out"),
    "percent-encoded mesh": (with_mesh("package://x/%2e%2e/%2e%2e/etc"), "climbs out"),
    "backslash mesh": (with_mesh("package://x\\..\\..\\etc"), "climbs out"),
}
"""The same of addresses of meshes that are never followed: why they are dropped."""
