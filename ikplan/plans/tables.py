"""A plan as tables: for pandas, and for a notebook."""

from __future__ import annotations

import base64
import html
import io
from typing import TYPE_CHECKING

import numpy as np

from ikplan.errors import InvalidRequest
from ikplan.plans.summary import certificate_rows

if TYPE_CHECKING:
    from pandas import DataFrame

    from ikplan.documents.plan_document import PlanDocument

__all__ = ["html_summary", "samples_frame"]

_SYMBOLS = (("q", ""), ("dq", "/s"), ("ddq", "/s^2"))


def samples_frame(plan: PlanDocument) -> DataFrame:
    """Return the samples by time, see :meth:`ikplan.Plan.to_dataframe`.

    Raises:
        InvalidRequest: pandas is not installed.
    """
    try:
        import pandas as pd
    except ImportError as error:
        raise InvalidRequest(
            "to_dataframe needs pandas: pip install pandas", field="to_dataframe"
        ) from error
    motion = plan.trajectory
    names = [f"{symbol} {name}" for symbol, _ in _SYMBOLS for name in plan.joint_names]
    units = [f"{unit}{per}" for _, per in _SYMBOLS for unit in plan.joint_units]
    values = np.hstack([motion.q, motion.dq, motion.ddq])
    frame = pd.DataFrame(values, index=pd.Index(motion.time, name="time"), columns=names)
    frame.attrs["units"] = {"time": "s", **dict(zip(names, units, strict=True))}
    return frame


def html_summary(plan: PlanDocument) -> str:
    """Return the certificate as a table, and the figure, as HTML."""
    from ikplan.plans.figures.plan import draw_plan
    from ikplan.plans.figures.style import METADATA, style

    image = io.BytesIO()
    figure = draw_plan(plan)
    with style():
        figure.savefig(image, format="png", dpi=80, metadata=METADATA[".png"])
    rows = "".join(
        f"<tr><td>{html.escape(name)}</td><td>{html.escape(value)}</td></tr>"
        for name, value in certificate_rows(plan)
    )
    count = len(plan.waypoints.time)
    head = f"{html.escape(plan.robot)}: {count} waypoints in {plan.duration:.3f} s"
    picture = base64.b64encode(image.getvalue()).decode()
    return (
        f"<p><b>{head}</b> <code>{html.escape(plan.id)}</code></p><details><summary>Certificate"
        f"</summary><table>{rows}</table></details>"
        f'<img alt="{head}" src="data:image/png;base64,{picture}">'
    )
