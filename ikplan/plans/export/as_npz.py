"""The plan as numpy arrays, for ``numpy.load``."""

from __future__ import annotations

import io
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from ikplan.plans.export.formats import Format

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["FORMAT", "arrays"]

_EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest time a zip archive can tell


def arrays(plan: PlanDocument) -> dict[str, np.ndarray[Any, Any]]:
    """Return the arrays of a plan by name; the certificate is JSON text, ``stats`` is left out."""
    rows = plan.waypoints
    orientation_error = [np.nan if e is None else e for e in rows.orientation_error]
    return {
        "id": np.array(plan.id),
        "version": np.array(plan.version),
        "robot": np.array(plan.robot),
        "joint_names": np.array(plan.joint_names, dtype=np.str_),
        "joint_units": np.array(plan.joint_units, dtype=np.str_),
        "time": plan.trajectory.time,
        "q": plan.trajectory.q,
        "dq": plan.trajectory.dq,
        "ddq": plan.trajectory.ddq,
        "waypoint_q": rows.q,
        "waypoint_time": rows.time,
        "waypoint_position_error": rows.position_error,
        "waypoint_orientation_error": np.array(orientation_error, dtype=np.float64),
        "waypoint_elongation": rows.elongation,
        "certificate": np.array(plan.certificate.model_dump_json()),
    }


def encode(plan: PlanDocument) -> bytes:
    """Return an uncompressed npz archive that holds no time of day and no pickled object."""
    # numpy.savez stamps each member with the clock, so the archive is put together here.
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as members:
        for name, array in arrays(plan).items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.asarray(array, order="C"), allow_pickle=False)
            info = zipfile.ZipInfo(f"{name}.npy", date_time=_EPOCH)
            info.external_attr = 0o644 << 16
            members.writestr(info, member.getvalue())
    return archive.getvalue()


FORMAT = Format(
    name="npz",
    title="numpy arrays, for numpy.load",
    suffixes=(".npz",),
    media_type="application/x-npz",
    encode=encode,
)
