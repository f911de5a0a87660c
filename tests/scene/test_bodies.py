"""The bodies of the catalogue: where they stand, and that they enclose the meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.errors import InvalidRequest
from ikplan.robots import load_robot
from ikplan.robots.urdf.safe_xml import read_xml
from ikplan.scene.allowed import SAMPLES, self_pairs, spread_configurations
from ikplan.scene.body import ConvexPiece
from ikplan.scene.contacts import Contacts
from ikplan.scene.hulls import distance_beyond, hull_of
from ikplan.scene.links import links_of
from ikplan.scene.poses import carrier_poses
from ikplan.scene.robot_bodies import bodies_fingerprint, robot_bodies
from ikplan.scene.urdf_shapes import link_meshes, urdf_shapes
from tests.present import present

Array = NDArray[np.float64]
MESHES = (
    "panda", "ur3", "ur5", "ur10", "xarm7", "baxter_left", "baxter_right", "kinova_j2s6s200",
    "so101", "z1",
)  # fmt: skip


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_links_stand_where_pinocchio_has_them(name: str) -> None:
    robot = load_robot(name)
    zero = {joint: 0.0 for joint, _ in robot.description.shapes.fixed_joints}
    links = links_of(robot, zero)
    q = robot.random_configuration(np.random.default_rng(0))
    R, p = carrier_poses(robot, q)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(q))
    for link, carrier in links.carrier.items():
        frame = robot.model.getFrameId(link, pin.FrameType.BODY)
        T = robot.T_universe_base.inverse() * data.oMf[frame]
        rotation, origin = links.pose[link]
        np.testing.assert_allclose(R[carrier] @ rotation, T.rotation, atol=1e-12)
        np.testing.assert_allclose(R[carrier] @ origin + p[carrier], T.translation, atol=1e-12)


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_home_is_free_of_contact_with_itself(name: str) -> None:
    robot = load_robot(name)
    bodies = robot_bodies(robot)
    if not bodies.bodies:  # no shape is published: said, and never guessed
        assert bodies.unchecked
        with pytest.raises(InvalidRequest, match="links without a shape"):
            robot.clearance(robot.home)
        return
    found = robot.clearance(robot.home)
    assert found.distance > 0.002, found.pair
    assert found.pairs_checked >= 10


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_every_moving_link_has_a_shape_or_is_listed(name: str) -> None:
    robot = load_robot(name)
    found = robot_bodies(robot)
    moved = {body.carrier for body in found.bodies}
    listed = {found.links.carrier[link] for link in found.unchecked}
    joints = set(range(1, robot.model.njoints))
    if robot.description.coupling is None:
        assert joints <= moved | listed
    for body in found.bodies:
        assert body.source
        assert all(np.isfinite(piece.points).all() for piece in body.pieces)


def beyond_all(points: Array, pieces: tuple[ConvexPiece, ...]) -> Array:
    """How far points are outside the nearest of some pieces [m]."""
    gaps = []
    for piece in pieces:
        hull = hull_of(piece.points)
        assert hull is not None
        gaps.append(distance_beyond(points, hull) - piece.radius)
    least: Array = np.min(gaps, axis=0)
    return least


@pytest.mark.parametrize("name", MESHES)
def test_no_vertex_of_a_mesh_is_outside_its_pieces(name: str) -> None:
    """Nor the middle of a triangle or of an edge; of some 2,000 such points a mesh."""
    robot = load_robot(name)
    source = robot.description.shapes
    found = robot_bodies(robot)
    bodies = {body.name: body for body in found.bodies}
    meshes = link_meshes(source.urdf, source.folder, name)
    assert meshes
    for mesh in meshes:
        R, p = found.links.pose[mesh.link]
        corners = mesh.vertices[mesh.triangles] @ R.T + p
        middles = 0.5 * (corners + np.roll(corners, 1, axis=1)).reshape(-1, 3)
        places = np.concatenate([mesh.vertices @ R.T + p, corners.mean(axis=1), middles])
        places = places[:: max(1, len(places) // 2_000)]
        assert beyond_all(places, bodies[mesh.link].pieces).max() <= 1e-9, mesh.link


def test_pieces_of_a_split_mesh_are_tighter_than_its_hull() -> None:
    source = load_robot("ur5").description.shapes
    meshes = {m.link: m for m in link_meshes(source.urdf, source.folder, "ur5")}
    bodies = {body.name: body for body in robot_bodies(load_robot("ur5")).bodies}
    for link in ("upper_arm_link", "forearm_link"):
        pieces = bodies[link].pieces
        assert len(pieces) > 1
        assert bodies[link].excess <= 0.015
        volumes = [present(hull_of(piece.points)).volume for piece in pieces]
        assert sum(volumes) < present(hull_of(meshes[link].vertices)).volume


def test_fingers_stand_where_fixed_joints_put_them() -> None:
    robot = load_robot("panda")
    joint = "panda_finger_joint1"
    tips = {}
    for value in (None, 0.0, 0.03):
        given = None if value is None else {joint: value}
        bodies = {b.name: b for b in robot_bodies(robot, given).bodies}
        left, right = (
            np.concatenate([x.points for x in bodies[f"panda_{side}finger"].pieces])
            for side in ("left", "right")
        )
        tips[value] = (left, right)
    # The right finger follows the left one: both slide along the y axis of the hand.
    T = robot.model.frames[robot.tip_frame_id].placement
    for value, moved in ((None, 0.04), (0.03, 0.03)):
        left, right = (tips[value][k] - tips[0.0][k] for k in (0, 1))
        np.testing.assert_allclose(left @ T.rotation, [[0.0, moved, 0.0]] * len(left), atol=1e-12)
        np.testing.assert_allclose(
            right @ T.rotation, [[0.0, -moved, 0.0]] * len(right), atol=1e-12
        )


@pytest.mark.parametrize(
    ("given", "part"),
    [
        ({"panda_finger_joint": 0.0}, "panda_finger_joint1"),
        ({"panda_joint1": 0.0}, "on the chain"),
        ({"panda_finger_joint1": 1.0}, "0 to 0.04"),
    ],
)
def test_a_wrong_fixed_joint_is_refused(given: dict[str, float], part: str) -> None:
    with pytest.raises(InvalidRequest, match=part):
        robot_bodies(load_robot("panda"), given)


def test_the_other_arm_stands_with_the_base() -> None:
    found = robot_bodies(load_robot("baxter_left"))
    carriers = {body.name: body.carrier for body in found.bodies}
    assert carriers["right_upper_shoulder"] == carriers["right_wrist"] == 0
    assert carriers["left_upper_shoulder"] == 1
    assert carriers["left_wrist"] == 7


def test_a_mesh_that_is_not_found_is_listed_and_not_passed_over(tmp_path: Path) -> None:
    urdf = (
        '<robot name="r"><link name="a"><collision><geometry><sphere radius="0.1"/></geometry>'
        '</collision></link><link name="b"><collision><geometry>'
        '<mesh filename="package://none/b.stl"/></geometry></collision></link>'
        '<joint name="j" type="revolute"><origin xyz="0 0 1"/><parent link="a"/><child link="b"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>'
    )
    (tmp_path / "r.urdf").write_text(urdf)
    found = robot_bodies(load_robot(tmp_path / "r.urdf"))
    assert found.unchecked == ("b",)
    assert [body.name for body in found.bodies] == ["a"]
    assert "package://none/b.stl" in found.notes[0]


def test_loading_a_robot_opens_no_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    import ikplan.scene.urdf_shapes as module

    opened: list[object] = []
    monkeypatch.setattr(module, "read_vertices", lambda *a: opened.append(a))
    robot = load_robot("tiago")
    robot.fk(robot.home)
    assert not opened


def test_pairs_that_may_touch_have_a_reason_and_the_rest_is_kept_apart() -> None:
    for name in ("panda", "ur5", "iiwa14"):
        robot = load_robot(name)
        bodies = robot_bodies(robot).bodies
        kept, allowed = self_pairs(robot)
        apart = {frozenset((bodies[i].name, bodies[j].name)) for i, j in kept}
        may = {frozenset((a, b)) for a, b, _ in allowed}
        every = {
            frozenset((a.name, b.name)) for a in bodies for b in bodies if a.carrier != b.carrier
        }
        assert apart | may == every
        assert not apart & may
        assert all(why for _, _, why in allowed)


def test_no_pair_kept_apart_touches_always_and_none_is_dropped_for_never_touching() -> None:
    robot = load_robot("ur5")
    bodies = robot_bodies(robot).bodies
    kept, allowed = self_pairs(robot)
    contacts = Contacts(bodies, kept)
    touches = np.zeros(len(kept), dtype=np.int64)
    for q in spread_configurations(robot, SAMPLES):
        touches += contacts.touching(*carrier_poses(robot, q), np.arange(len(kept)))
    assert touches.max() < SAMPLES
    assert (touches == 0).any()  # seen apart everywhere, and still checked
    assert {why for _, _, why in allowed} == {"adjacent"}


def test_pairs_that_an_srdf_calls_never_are_checked_all_the_same() -> None:
    robot = load_robot("panda")
    _, allowed = self_pairs(robot)
    reasons = {why for _, _, why in allowed}
    assert reasons == {"SRDF: Adjacent", "SRDF: Default"}
    assert read_xml(robot.description.shapes.srdf, robot="panda").findall("disable_collisions")


def test_configurations_are_spread_over_the_limits() -> None:
    robot = load_robot("panda")
    q = spread_configurations(robot, SAMPLES)
    assert np.all((q >= robot.lower) & (q <= robot.upper))
    share = (q - robot.lower) / (robot.upper - robot.lower)
    np.testing.assert_allclose(share.mean(axis=0), 0.5, atol=0.02)
    counts = [np.histogram(column, bins=8, range=(0, 1))[0] for column in share.T]
    assert np.min(counts) >= 24  # of 32


def test_a_primitive_of_a_urdf_stands_at_its_origin() -> None:
    urdf = (
        b'<robot name="r"><link name="a"><collision>'
        b'<origin xyz="1 2 3" rpy="0 1.5707963267948966 0"/>'
        b'<geometry><box size="2 4 6"/></geometry></collision></link></robot>'
    )
    (piece,) = urdf_shapes(urdf, None, "r")["a"].pieces
    np.testing.assert_allclose(piece.points.min(axis=0), [-2, 0, 2], atol=1e-12)
    np.testing.assert_allclose(piece.points.max(axis=0), [4, 4, 4], atol=1e-12)


def test_the_fingerprint_of_bodies_is_of_the_bodies_and_not_of_the_tool() -> None:
    prints = {
        name: bodies_fingerprint(load_robot(name)) for name in ("panda", "fr3", "ur5", "ur5e")
    }
    assert len(set(prints.values())) == len(prints)
    assert bodies_fingerprint(load_robot("ur5").with_tool([0, 0, 0.1])) == prints["ur5"]
