"""The planner's bodies against the meshes they enclose, at random configurations among boxes."""

from __future__ import annotations

import time
from dataclasses import dataclass

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from benchmarks.collision.drawing import rotation
from benchmarks.collision.oracle import coal_shape
from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.robots import Robot, load_robot
from ikplan.scene.body import Body, CollisionModel
from ikplan.scene.links import links_of
from ikplan.scene.model import collision_model
from ikplan.scene.urdf_shapes import MeshGeometry, link_meshes

__all__ = ["ROBOTS", "BodyStudy", "body_study"]

Array = NDArray[np.float64]
Shape = tuple[coal.CollisionGeometry, pin.SE3]

ROBOTS = ("panda", "ur3", "ur5", "ur10", "xarm7", "kinova_j2s6s200")
SCENES = 20
BOXES = 6


@dataclass
class BodyStudy:
    """What the bodies of one robot say beside its meshes.

    Attributes:
        count: Configurations.
        touching: Those in contact by the meshes.
        missed: Those of them that the bodies call free.
        alarms: Configurations free by the meshes that the bodies call in contact.
        alone: Those of them where the arm is in contact with itself.
        checker_us: Time of the planner's check [us].
        mesh_us: Time of coal's on the meshes [us].
    """

    count: int = 0
    touching: int = 0
    missed: int = 0
    alarms: int = 0
    alone: int = 0
    checker_us: float = 0.0
    mesh_us: float = 0.0

    @property
    def alarm_share(self) -> float:
        """False alarms as a share of the free configurations."""
        return self.alarms / max(self.count - self.touching, 1)


def mesh_shape(mesh: MeshGeometry) -> coal.CollisionGeometry:
    """Return the triangles of a mesh for coal; they are hollow."""
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.triangles), len(mesh.vertices))
    model.addVertices(mesh.vertices)
    model.addTriangles(mesh.triangles.astype(np.int64))
    model.endModel()
    return model


class MeshOracle:
    """Contacts of the meshes of a robot, where a link has any, and of pieces elsewhere."""

    def __init__(self, robot: Robot, model: CollisionModel, meshes: dict[str, list[Shape]]) -> None:
        """Put every shape and every pair that the model asks for into a geometry model."""
        self.robot = robot
        self.geometry = pin.GeometryModel()
        ids: list[list[int]] = []
        for body in model.bodies:
            base = robot.T_universe_base if body.carrier == 0 else pin.SE3.Identity()
            rows = []
            for k, (shape, placement) in enumerate(_shapes(body, meshes)):
                item = pin.GeometryObject(f"{body.name} {k}", body.carrier, base * placement, shape)
                rows.append(self.geometry.addGeometryObject(item))
            ids.append(rows)
        for a, b in model.pairs.tolist():
            for i in ids[a]:
                for j in ids[b]:
                    self.geometry.addCollisionPair(pin.CollisionPair(i, j))
        self.data, self.geometry_data = robot.model.createData(), self.geometry.createData()

    def touching(self, q: Array) -> NDArray[np.bool_]:
        """Whether surfaces cut each other at configurations, shape (m,)."""
        return np.array(
            [
                pin.computeCollisions(
                    self.robot.model, self.data, self.geometry, self.geometry_data, row, True
                )
                for row in self.robot.configurations(q)
            ],
            dtype=np.bool_,
        )


def _shapes(body: Body, meshes: dict[str, list[Shape]]) -> list[Shape]:
    found = meshes.get(body.name)
    return [coal_shape(piece) for piece in body.pieces] if found is None else found


def _link_shapes(robot: Robot) -> dict[str, list[Shape]]:
    source, links = robot.description.shapes, links_of(robot, {})
    found: dict[str, list[Shape]] = {}
    for mesh in link_meshes(source.urdf, source.folder, robot.name):
        if mesh.link in links.pose:
            placement = pin.SE3(*links.pose[mesh.link])
            found.setdefault(mesh.link, []).append((mesh_shape(mesh), placement))
    return found


def _scene(rng: np.random.Generator, reach: float) -> Scene:
    boxes = [
        {
            "name": f"box {k}",
            "shape": {"type": "box", "size": rng.uniform(0.05, 0.4, 3).tolist()},
            "position": (reach * rng.uniform(-1.0, 1.0, 3)).tolist(),
            "quaternion_xyzw": pin.Quaternion(rotation(rng)).coeffs().tolist(),
        }
        for k in range(BOXES)
    ]
    return parse(Scene, {"obstacles": boxes})


def body_study(name: str, count: int, seed: int = 0) -> BodyStudy:
    """Compare what bodies and meshes say at random configurations, among boxes of 20 scenes.

    Meshes are hollow: coal sees their surfaces only. A box as small as they are has edges of 5 cm
    and may be inside of one; that would count as a false alarm, never as a miss.

    Args:
        name: A robot of the catalogue with meshes.
        count: How many configurations.
        seed: Of scenes and configurations.
    """
    robot, rng = load_robot(name), np.random.default_rng(seed)
    meshes, study = _link_shapes(robot), BodyStudy()
    reach = float(np.linalg.norm(robot.fk(robot.home).translation)) + 0.2
    alone = CollisionChecker(robot, collision_model(robot))
    for part in np.array_split(np.arange(count), SCENES):
        if not len(part):
            continue
        model = collision_model(robot, _scene(rng, reach))
        q = np.array([robot.random_configuration(rng) for _ in part])
        checker, oracle = CollisionChecker(robot, model), MeshOracle(robot, model, meshes)
        checker.free(q[:1])
        begin = time.thread_time()
        free = checker.free(q)
        middle = time.thread_time()
        touching = oracle.touching(q)
        study.checker_us += 1e6 * (middle - begin) / count
        study.mesh_us += 1e6 * (time.thread_time() - middle) / count
        study.count += len(part)
        study.touching += int(touching.sum())
        study.missed += int((touching & free).sum())
        alarms = ~touching & ~free
        study.alarms += int(alarms.sum())
        study.alone += int((alarms & ~alone.free(q)).sum())
    return study
