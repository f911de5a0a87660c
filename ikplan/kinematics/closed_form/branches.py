"""The branches of a tool pose in closed form.

With ``E_i`` the rotation about axis ``h_i`` by ``q_i`` and ``R`` the tool at joint values of zero,
the tool is turned by ``E_1 ... E_6 R``, and the wrist centre W, which joints 5 and 6 keep in place,
is at ``v_1 + E_1 (v_2 + E_2 (v_3 + ...))``. Source: Elias and Wen (see ``subproblems``), section 4:
spherical wrists, and three parallel axes of which the last two meet.
"""

from __future__ import annotations

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array
from ikplan.kinematics.closed_form.form import (
    FIRST_MEET,
    SECOND_MEET,
    SECOND_PARALLEL,
    THREE_PARALLEL,
    ClosedForm,
)
from ikplan.kinematics.closed_form.subproblems import (
    Vector,
    angle_between,
    angles_of_projection,
    dot,
    minus,
    plus,
    row,
    turned,
    two_turns,
)

__all__ = ["MOST_BRANCHES", "branches_into"]

MOST_BRANCHES = 8

Rotation = tuple[Vector, Vector, Vector]
"""A rotation as its columns."""


@leaf_kernel
def _times(M: Rotation, a: Vector) -> Vector:
    """Return a vector turned."""
    x, y, z = M
    return (
        a[0] * x[0] + a[1] * y[0] + a[2] * z[0],
        a[0] * x[1] + a[1] * y[1] + a[2] * z[1],
        a[0] * x[2] + a[1] * y[2] + a[2] * z[2],
    )


@leaf_kernel
def _transposed_times(M: Rotation, a: Vector) -> Vector:
    """Return a vector turned back."""
    return dot(M[0], a), dot(M[1], a), dot(M[2], a)


@leaf_kernel
def _first_angle(d: Vector, form: ClosedForm, known: float) -> tuple[int, float, float, bool]:
    """The angles of joint 1 by what turning joints parallel to axis 2 cannot change of W."""
    h1, h2 = row(form.h, 0), row(form.h, 1)
    count, a, b, unsure = angles_of_projection(h2, h1, d, known)
    return count, -a, -b, unsure


@leaf_kernel
def _elbow(
    upper: Vector, k: Vector, fore: Vector, squared: float
) -> tuple[int, float, float, bool]:
    """The angles about k at which |upper + turned(k, angle, fore)|^2 is ``squared``."""
    rest = 0.5 * (squared - dot(upper, upper) - dot(fore, fore))
    return angles_of_projection(upper, k, fore, rest)


@leaf_kernel
def _second_parallel(form: ClosedForm, d: Vector, out: Array) -> tuple[int, bool]:
    h1, h2, h3 = row(form.h, 0), row(form.h, 1), row(form.h, 2)
    v2, v3, v4 = row(form.v, 1), row(form.v, 2), row(form.v, 3)
    ones, a, b, unsure = _first_angle(d, form, dot(h2, v2) + dot(h2, v3) + dot(h2, v4))
    count = 0
    for i in range(ones):
        q1 = a if i == 0 else b
        y = minus(turned(h1, -q1, d), v2)
        threes, e, f, doubtful = _elbow(v3, h3, v4, dot(y, y))
        unsure = unsure or doubtful
        for j in range(threes):
            q3 = e if j == 0 else f
            x = plus(v3, turned(h3, q3, v4))
            out[2 * count, 0], out[2 * count, 2] = q1, q3
            out[2 * count, 1] = angle_between(h2, x, y)
            count += 1
    return count, unsure


@leaf_kernel
def _first_meet(form: ClosedForm, d: Vector, out: Array) -> tuple[int, bool]:
    h1, h2, h3 = row(form.h, 0), row(form.h, 1), row(form.h, 2)
    v3, v4 = row(form.v, 2), row(form.v, 3)
    threes, e, f, unsure = _elbow(v3, h3, v4, dot(d, d))
    count = 0
    for j in range(threes):
        q3 = e if j == 0 else f
        x = plus(v3, turned(h3, q3, v4))
        both, one, two, other_one, other_two, doubtful = two_turns(h1, d, h2, x)
        unsure = unsure or doubtful
        for i in range(both):
            out[2 * count, 0] = -(one if i == 0 else other_one)
            out[2 * count, 1] = two if i == 0 else other_two
            out[2 * count, 2] = q3
            count += 1
    return count, unsure


@leaf_kernel
def _second_meet(form: ClosedForm, d: Vector, out: Array) -> tuple[int, bool]:
    h1, h2, h3 = row(form.h, 0), row(form.h, 1), row(form.h, 2)
    v2, v4 = row(form.v, 1), row(form.v, 3)
    rest = 0.5 * (dot(d, d) + dot(v2, v2) - dot(v4, v4))
    ones, a, b, unsure = angles_of_projection(d, h1, v2, rest)
    count = 0
    for i in range(ones):
        q1 = a if i == 0 else b
        y = minus(turned(h1, -q1, d), v2)
        both, two, three, other_two, other_three, doubtful = two_turns(h2, y, h3, v4)
        unsure = unsure or doubtful
        for j in range(both):
            out[2 * count, 0] = q1
            out[2 * count, 1] = -(two if j == 0 else other_two)
            out[2 * count, 2] = three if j == 0 else other_three
            count += 1
    return count, unsure


@leaf_kernel
def _first_parallel(form: ClosedForm, d: Vector, out: Array) -> tuple[int, bool]:
    h1, h2, h3 = row(form.h, 0), row(form.h, 1), row(form.h, 2)
    v2, v3, v4 = row(form.v, 1), row(form.v, 2), row(form.v, 3)
    known = dot(h1, d) - dot(h1, v2) - dot(h1, v3)
    threes, e, f, unsure = angles_of_projection(h1, h3, v4, known)
    count = 0
    for j in range(threes):
        q3 = e if j == 0 else f
        x = plus(v3, turned(h3, q3, v4))
        twos, a, b, doubtful = _elbow(v2, h2, x, dot(d, d))
        unsure = unsure or doubtful
        for i in range(twos):
            q2 = a if i == 0 else b
            out[2 * count, 1], out[2 * count, 2] = q2, q3
            out[2 * count, 0] = angle_between(h1, plus(v2, turned(h2, q2, x)), d)
            count += 1
    return count, unsure


@leaf_kernel
def _spherical(form: ClosedForm, d: Vector, turn: Rotation, out: Array) -> tuple[int, bool]:
    """Write the branches of an arm with a spherical wrist.

    Args:
        form: The arm.
        d: Wrist centre from the point on axis 1 [m].
        turn: The whole turn of the tool from joint values of zero.
        out: Out: the branches.
    """
    if form.kind == SECOND_PARALLEL:
        arms, unsure = _second_parallel(form, d, out)
    elif form.kind == FIRST_MEET:
        arms, unsure = _first_meet(form, d, out)
    elif form.kind == SECOND_MEET:
        arms, unsure = _second_meet(form, d, out)
    else:
        arms, unsure = _first_parallel(form, d, out)
    h1, h2, h3 = row(form.h, 0), row(form.h, 1), row(form.h, 2)
    h4, h5, h6 = row(form.h, 3), row(form.h, 4), row(form.h, 5)
    c5, c6 = _times(turn, h5), _times(turn, h6)
    count = 0
    for i in range(arms):
        q1, q2, q3 = out[2 * i, 0], out[2 * i, 1], out[2 * i, 2]
        # E_4 E_5 E_6 turns axes 6 and 5 to these.
        r6 = turned(h3, -q3, turned(h2, -q2, turned(h1, -q1, c6)))
        r5 = turned(h3, -q3, turned(h2, -q2, turned(h1, -q1, c5)))
        fives, a, b, doubtful = angles_of_projection(h4, h5, h6, dot(h4, r6))
        unsure = unsure or doubtful
        for j in range(fives):
            q5 = a if j == 0 else b
            q4 = angle_between(h4, turned(h5, q5, h6), r6)
            out[count, 0], out[count, 1], out[count, 2], out[count, 3] = q1, q2, q3, q4
            out[count, 4] = q5
            out[count, 5] = angle_between(h6, h5, turned(h5, -q5, turned(h4, -q4, r5)))
            count += 1
    return count, unsure


@leaf_kernel
def _three_parallel(form: ClosedForm, d: Vector, turn: Rotation, out: Array) -> tuple[int, bool]:
    """Write the branches of an arm whose axes 2, 3 and 4 are parallel, as ``_spherical`` does."""
    h1, h2, h3 = row(form.h, 0), row(form.h, 1), row(form.h, 2)
    h5, h6 = row(form.h, 4), row(form.h, 5)
    v2, v3, v4, v5 = row(form.v, 1), row(form.v, 2), row(form.v, 3), row(form.v, 4)
    known = dot(h2, v2) + dot(h2, v3) + dot(h2, v4) + dot(h2, v5)
    ones, a, b, unsure = _first_angle(d, form, known)
    count = 0
    for i in range(ones):
        q1 = a if i == 0 else b
        n = turned(h1, q1, h2)
        y = minus(turned(h1, -q1, d), v2)
        fives, e, f, doubtful = angles_of_projection(h2, h5, h6, dot(n, _times(turn, h6)))
        unsure = unsure or doubtful
        for j in range(fives):
            q5 = e if j == 0 else f
            # E_6^T takes E_5^T h_2 to where the whole turn, taken back, has axis 2.
            q6 = -angle_between(h6, turned(h5, -q5, h2), _transposed_times(turn, n))
            # E_2 E_3 E_4 is a turn about axis 2 that takes axis 5 as far as E_1^T ... E_6^T does.
            wanted = turned(h1, -q1, _times(turn, turned(h6, -q6, h5)))
            whole = angle_between(h2, h5, wanted)
            x = minus(y, turned(h2, whole, v5))
            threes, g, k, bent = _elbow(v3, h3, v4, dot(x, x))
            unsure = unsure or bent
            for m in range(threes):
                q3 = g if m == 0 else k
                q2 = angle_between(h2, plus(v3, turned(h3, q3, v4)), x)
                out[count, 0], out[count, 1], out[count, 2] = q1, q2, q3
                out[count, 3] = form.sign[1] * (whole - q2 - form.sign[0] * q3)
                out[count, 4], out[count, 5] = q5, q6
                count += 1
    return count, unsure


@leaf_kernel
def branches_into(form: ClosedForm, R: Array, p: Array, out: Array) -> tuple[int, bool]:
    """Write every branch of a tool pose.

    Args:
        form: The arm; of a kind that is known.
        R: Rotation of the tool in the base, shape (3, 3).
        p: Position of the tool in the base, shape (3,) [m].
        out: Out: joint values of each branch, shape (8, 6) [rad], without regard to limits and
            full turns.

    Returns:
        Number of branches, and whether they may not be all: the pose is singular, or so near to
        it that branches meet or vanish by rounding. Branches of such a pose are right only as far
        as that allows.
    """
    w, S = form.centre, form.R
    d = (
        p[0] + R[0, 0] * w[0] + R[0, 1] * w[1] + R[0, 2] * w[2] - form.v[0, 0],
        p[1] + R[1, 0] * w[0] + R[1, 1] * w[1] + R[1, 2] * w[2] - form.v[0, 1],
        p[2] + R[2, 0] * w[0] + R[2, 1] * w[1] + R[2, 2] * w[2] - form.v[0, 2],
    )
    a, b, c = row(R, 0), row(R, 1), row(R, 2)
    x, y, z = row(S, 0), row(S, 1), row(S, 2)
    turn = (
        (dot(a, x), dot(b, x), dot(c, x)),
        (dot(a, y), dot(b, y), dot(c, y)),
        (dot(a, z), dot(b, z), dot(c, z)),
    )
    if form.kind == THREE_PARALLEL:
        return _three_parallel(form, d, turn, out)
    return _spherical(form, d, turn, out)
