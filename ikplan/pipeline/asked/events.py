"""When the events of a request are, on its finished motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.requested import RequestedMotion, ToolLeg
from ikplan.documents.path import Event
from ikplan.documents.trajectory import EventResult
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot
from ikplan.timing import TimedPath

__all__ = ["EventFinder"]

_POINTS = 400
"""Points of a stretch at which the tool is looked at first."""
_HALVINGS = 60
_FITS = 1e-9
"""What a distance may be beyond its segment by, for rounding [m]."""


@dataclass(frozen=True, eq=False)
class EventFinder:
    """Finds events on a finished motion.

    Attributes:
        robot: The robot, with its tool.
        timed: The motion.
        motion: What the request asks of it, read for the certificate.
        count: Number of segments, or of waypoints where the path has those.
        waypoint_time: When each waypoint is passed, shape (n,) [s].
        segments: Whether the path has segments.
    """

    robot: Robot
    timed: TimedPath
    motion: RequestedMotion
    count: int
    waypoint_time: Array
    segments: bool

    def found(self, event: Event, field: str) -> EventResult:
        """Return when an event is.

        Args:
            event: The event.
            field: Its field of the request.

        Raises:
            InvalidRequest: There is no such segment, or the place or time is beyond it.
        """
        begin, end = self._window(event, field)
        if event.time is not None:
            time = (begin if event.time >= 0.0 else end) + event.time
            if not begin - _FITS <= time <= end + _FITS:
                raise _beyond(f"{field}.time", event.time, end - begin, "s")
            return self._result(event, min(max(time, 0.0), self.timed.duration), None)
        assert event.distance is not None
        leg = self._leg(event)
        if leg is None:
            return self._on_own_way(event, field, begin, end)
        return self._on_leg(event, field, *leg)

    def _window(self, event: Event, field: str) -> tuple[float, float]:
        """When the segment of an event begins and ends [s]."""
        if event.segment is None:
            return 0.0, self.timed.duration
        if event.segment >= self.count:
            raise InvalidRequest(
                f"{field}.segment: there is no segment {event.segment}",
                field=f"{field}.segment",
                allowed=f"0 to {self.count - 1}",
            )
        name = f"path.segments[{event.segment}]"
        last = self.motion.last_rows[name] if self.segments else event.segment
        for joint in self.motion.joint_segments:
            if joint.field == name:
                row = joint.begin_row
                begin = 0.0 if row is None else float(self.waypoint_time[row])
                return begin, float(self.waypoint_time[joint.end_row])
        found = self._leg(event)
        if found is not None:
            leg, low, high = found
            s, t = self._known(leg)
            return float(np.interp(low, s, t)), float(np.interp(high, s, t))
        begin = 0.0 if last == 0 else float(self.waypoint_time[last - 1])
        return begin, float(self.waypoint_time[last])

    def _leg(self, event: Event) -> tuple[ToolLeg, float, float] | None:
        """The tool path that an event is on, and where its segment begins and ends on it [m]."""
        if event.segment is None:
            return None
        for leg in self.motion.legs:
            for part in leg.path.segments:
                if self.segments and part.field == f"path.segments[{event.segment}]":
                    return leg, part.begin, part.end
            if not self.segments:
                places = [0.0] + [s for s, _ in leg.path.waypoints]
                for k, (s, row) in enumerate(leg.path.waypoints):
                    if row == event.segment:
                        return leg, places[k], s
        return None

    def _known(self, leg: ToolLeg) -> tuple[Array, Array]:
        """Path lengths of a tool path whose times are known, and the times."""
        times = self.waypoint_time
        begin = 0.0 if leg.begin_row is None else float(times[leg.begin_row])
        s = np.array([0.0, *(s for s, _ in leg.path.waypoints)])
        return s, np.array([begin, *(float(times[row]) for _, row in leg.path.waypoints)])

    def _on_leg(
        self, event: Event, field: str, leg: ToolLeg, begin: float, end: float
    ) -> EventResult:
        assert event.distance is not None
        wanted = (begin if event.distance >= 0.0 else end) + event.distance
        if not begin - _FITS <= wanted <= end + _FITS:
            raise _beyond(f"{field}.distance", event.distance, end - begin, "m")
        wanted = min(max(wanted, 0.0), leg.path.length)
        at = np.array([wanted])
        piece = leg.path.piece_at(at)
        place = leg.path.derivatives(piece, at - leg.path.begins[piece])
        p, ahead = place.p[0], place.v[0]
        s, t = self._known(leg)
        k = int(np.clip(np.searchsorted(s, wanted, "right") - 1, 0, len(s) - 2))
        times = np.linspace(t[k], t[k + 1], _POINTS)
        off = (self._positions(times) - p) @ ahead
        way = np.cumsum(np.linalg.norm(np.diff(self._positions(times), axis=0), axis=1))
        way = np.append(0.0, way) * (s[k + 1] - s[k]) / max(float(way[-1]), 1e-300)
        # Where the way gone says, the sign of the distance ahead changes next to it.
        guess = int(np.argmin(np.abs(way - (wanted - s[k]))))
        low = max(guess - 2, 0)
        high = min(guess + 2, _POINTS - 1)
        if off[low] > 0.0:
            high = low
        elif off[high] < 0.0:
            low = high
        a, b = float(times[low]), float(times[high])
        for _ in range(_HALVINGS):
            middle = 0.5 * (a + b)
            if not a < middle < b:
                break
            if float((self._positions(np.array([middle]))[0] - p) @ ahead) < 0.0:
                a = middle
            else:
                b = middle
        error = float(np.linalg.norm(self._positions(np.array([b]))[0] - p))
        return self._result(event, b, error)

    def _on_own_way(self, event: Event, field: str, begin: float, end: float) -> EventResult:
        """An event on a motion of the joints: the tool has gone so far."""
        assert event.distance is not None
        times = np.linspace(begin, end, 16 * _POINTS + 1)
        p = self._positions(times)
        way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1)))
        whole = float(way[-1])
        wanted = event.distance if event.distance >= 0.0 else whole + event.distance
        if not -_FITS <= wanted <= whole + _FITS:
            raise _beyond(f"{field}.distance", event.distance, whole, "m")
        return self._result(event, float(np.interp(wanted, way, times)), 0.0)

    def _positions(self, times: Array) -> Array:
        q, _, _ = self.timed.evaluate(times)
        return np.array([self.robot.fk(row).translation for row in q])

    def _result(self, event: Event, time: float, error: float | None) -> EventResult:
        q, _, _ = self.timed.evaluate(np.array([time]))
        return EventResult(
            name=event.name,
            segment=event.segment,
            time=time,
            position=self.robot.fk(q[0]).translation,
            q=q[0],
            position_error=error,
        )


def _beyond(field: str, value: float, whole: float, unit: str) -> InvalidRequest:
    return InvalidRequest(
        f"{field}: {value:g} {unit} is beyond the segment, which has {whole:.6g} {unit}",
        field=field,
        allowed=f"-{whole:.6g} to {whole:.6g} {unit}",
    )
