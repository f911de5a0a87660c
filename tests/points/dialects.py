"""CSV files as people have them, with what they mean: rotations by Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import radians
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
AXES = {"x": np.array([1.0, 0, 0]), "y": np.array([0, 1.0, 0]), "z": np.array([0, 0, 1.0])}


def turns(order: str, *degrees: float) -> Matrix:
    """The product of turns about these axes, from left to right."""
    R = np.eye(3)
    for axis, angle in zip(order, degrees, strict=True):
        R = R @ pin.AngleAxis(radians(angle), AXES[axis]).toRotationMatrix()
    return R


def vector(*v: float) -> Matrix:
    return np.asarray(pin.exp3(np.array(v)))


def quaternion(x: float, y: float, z: float, w: float) -> Matrix:
    return np.asarray(pin.Quaternion(np.array([x, y, z, w])).matrix())


Oriented = Matrix | Callable[[Matrix], bool] | None


@dataclass(frozen=True)
class Dialect:
    """A file and what it means.

    Attributes:
        name: Its name, for the test.
        text: The file, or its bytes.
        points: Positions in metres.
        rotations: What is asked of the tool at each; None: nothing.
        options: What the caller says.
        notes: Words that are said of it.
        expected: Further attributes of the points.
    """

    name: str
    text: str | bytes
    points: Sequence[Sequence[float]]
    rotations: Sequence[Oriented] = ()
    options: dict[str, str] = field(default_factory=dict)
    notes: Sequence[str] = ()
    expected: dict[str, Any] = field(default_factory=dict)


def along(axis: int, *direction: float) -> Callable[[Matrix], bool]:
    return lambda R: bool(np.allclose(R[:, axis], direction, atol=1e-9))


S = 0.5**0.5
A, B = (0.565, -0.12, 0.3), (0.4, 0.25, 0.35)

READ = [
    # The thirteen that users were seen with.
    Dialect("metres and a quaternion",
        "x,y,z,qx,qy,qz,qw\n0.565,-0.12,0.3,0,1,0,0\n0.4,0.25,0.35,0.5,0.5,0.5,0.5\n",
        [A, B], [quaternion(0, 1, 0, 0), quaternion(0.5, 0.5, 0.5, 0.5)],
        notes=["read as metres", "unit quaternion"]),
    Dialect("the scalar part first",
        "x,y,z,qw,qx,qy,qz\n0.565,-0.12,0.3,0.8,0.6,0,0\n", [A], [quaternion(0.6, 0, 0, 0.8)],
        notes=["scalar part first"]),
    Dialect("Universal Robots",
        "x,y,z,rx,ry,rz\n565,-120,300,2.2,-2.2,0.1\n400,250,350,0,3.1415927,0\n",
        [A, B], [vector(2.2, -2.2, 0.1), vector(0, 3.1415927, 0)],
        notes=["millimetres, because a coordinate of 565", "Universal Robots"]),
    Dialect("KUKA", "X,Y,Z,A,B,C\n565,-120,300,10,20,-170\n", [A], [turns("zyx", 10, 20, -170)],
        notes=["KUKA", "in deg"]),
    Dialect("FANUC", "X,Y,Z,W,P,R\n565,-120,300,-180,5,30\n", [A], [turns("zyx", 30, 5, -180)],
        notes=["FANUC", "in deg"]),
    Dialect("roll, pitch, yaw in degrees",
        "x,y,z,roll,pitch,yaw\n0.565,-0.12,0.3,180,10,-45\n", [A], [turns("zyx", -45, 10, 180)],
        notes=["degrees, because an angle of 180", "ROS"]),
    Dialect("no header, columns given", "0.565,-0.12,0.3,0,1,0,0\n", [A], [quaternion(1, 0, 0, 0)],
        options={"columns": "x,y,z,qw,qx,qy,qz"}),
    Dialect("semicolons and decimal commas",
        "x;y;z;rx;ry;rz\n0,565;-0,12;0,3;0;3,1;0\n", [A], [vector(0, 3.1, 0)]),
    Dialect("tool axis",
        "X,Y,Z,I,J,K\n565,-120,300,0,0,-1\n400,250,350,0.6,0,-0.8\n",
        [A, B], [along(2, 0, 0, -1), along(2, 0.6, 0, -0.8)],
        notes=["tool's z points along"], expected={"free_axis": "tool_z"}),
    Dialect("extra columns",
        "id,name,x,y,z,qx,qy,qz,qw,speed\n1,P1,565,-120,300,0,1,0,0,250\n2,P2,400,250,350,0,1,0,0,\n",
        [A, B], [quaternion(0, 1, 0, 0)] * 2, notes=["passed over: id, name"]),
    Dialect("blank lines, blanks and comments",
        "# made by hand\n\n x , y , z \n\n 0.565, -0.12 ,0.3\n   \n# between\n0.4,0.25,0.35\n\n",
        [A, B]),
    Dialect("millimetres without a unit", "x,y,z\n565,-120,300\n400,250,350\n", [A, B],
        notes=["lengths read as millimetres"]),
    Dialect("units in the header",
        "x [mm],y [mm],z [mm],roll [deg],pitch [deg],yaw [deg]\n565,-120,300,1,2,3\n",
        [A], [turns("zyx", 3, 2, 1)]),
    # And more.
    Dialect("units behind names", "x_mm;y_mm;z_mm;yaw_rad;pitch_rad;roll_rad\n565;-120;300;5;0;0\n",
        [A], [turns("z", np.degrees(5))]),
    Dialect("units given", "x,y,z,roll,pitch,yaw\n5.65,-1.2,3,1,2,3\n", [(0.0565, -0.012, 0.03)],
        [turns("zyx", 3, 2, 1)], options={"units": "cm", "angles": "deg"}),
    Dialect("units in a row of their own",
        "x,y,z,rx,ry,rz\nmm,mm,mm,rad,rad,rad\n5,6,7,0,0,1\n", [(0.005, 0.006, 0.007)],
        [vector(0, 0, 1)]),
    Dialect("tabs and a byte order mark", "\ufeffX\tY\tZ\n0.565\t-0.12\t0.3\n", [A]),
    Dialect("Excel's Unicode text", "x\ty\tz\r\n0,565\t-0,12\t0,3\r\n".encode("utf-16"), [A]),
    Dialect("Excel's separator line", "sep=;\nx;y;z\n565;-120;300\n", [A]),
    Dialect("an old code page", "x [mm];y [mm];z [mm];A [°];B [°];C [°]\n565;-120;300;9;0;0\n"
        .encode("cp1252"), [A], [turns("z", 9)]),
    Dialect("spaces and decimal commas", "0,565  -0,12 0,3\n0,4 0,25 0,35\n", [A, B],
        notes=["no header"]),
    Dialect("a trajectory of TUM",
        "# timestamp tx ty tz qx qy qz qw\n1.0 0.565 -0.12 0.3 0 0.6 0 0.8\n", [A],
        [quaternion(0, 0.6, 0, 0.8)], notes=["comment on line 1"], expected={"timed": True}),
    Dialect("a ROS topic",
        "pose.position.x,pose.position.y,pose.position.z,pose.orientation.x,pose.orientation.y,"
        "pose.orientation.z,pose.orientation.w\n0.565,-0.12,0.3,0.6,0,0,0.8\n",
        [A], [quaternion(0.6, 0, 0, 0.8)]),
    Dialect("ABB", "X,Y,Z,q1,q2,q3,q4,zone\n565,-120,300,0,0,1,0,z10\n400,250,350,0,0,1,0,fine\n",
        [A, B], [quaternion(0, 1, 0, 0)] * 2, notes=["scalar part first"],
        expected={"zones": [0.01, 0.0]}),
    Dialect("CAM axis from the tip to the spindle", "x,y,z,i,j,k\n565,-120,300,0,0.6,0.8\n",
        [A], [along(2, 0, -0.6, -0.8)], options={"free_axis": "-z"},
        expected={"free_axis": "tool_z"}),
    Dialect("an axis other than z", "x,y,z,i,j,k\n565,-120,300,0,0.6,0.8\n",
        [A], [along(0, 0, 0.6, 0.8)], options={"free_axis": "x"}, expected={"free_axis": "tool_x"}),
    Dialect("some rows without orientation",
        "x,y,z,rx,ry,rz\n0.565,-0.12,0.3,,,\n0.4,0.25,0.35,0,3,0\n", [A, B],
        [None, vector(0, 3, 0)]),
    Dialect("a rotation vector in degrees", "x,y,z,rx,ry,rz\n565,-120,300,0,90,0\n", [A],
        [turns("y", 90)], options={"angles": "deg"}),
    Dialect("columns to pass over",
        "P1,565,-120,300,1,2\nP2,400,250,350,3,4\n", [A, B], options={"columns": "-,x,y,z,-,-"}),
    Dialect("quoted cells", '"x","y","z"\n"0,565","-0,12","0,3"\n', [A]),
    Dialect("a cell of nothing at the end", "x,y,z,\n565,-120,300,\n", [A]),
    Dialect("inches", "x (in),y (in),z (in)\n10,0,5\n", [(0.254, 0.0, 0.127)]),
]  # fmt: skip

REFUSED = [
    ("x,y\n1,2\n", "line 1", "z is missing"),
    ("x,y,z,qx,qy\n1,2,3,4,5\n", "line 1", "qz, qw is missing"),
    ("x,y,z,qx,qy,qz,qw,yaw\n1,2,3,0,0,0,1,0\n", "line 1", "two orientations"),
    ("x,y,x\n1,2,3\n", "line 1, column x", "same as column 'x'"),
    ("x,y,z,rol,pitch,yaw\n1,2,3,0,0,0\n", "line 1", "is column 'rol' meant for it?"),
    ("x,y,z,alpha,beta,gamma\n1,2,3,0,0,0\n", "columns", "column 'alpha'"),
    ("x,y,z,nx,ny,nz\n1,2,3,0,0,1\n", "columns", "column 'nx'"),
    ("0.1,0.2,0.3,0,0,0,1\n", "columns", "x,y,z,qx,qy,qz,qw or x,y,z,qw,qx,qy,qz"),
    ("P1,0.1,0.2,0.3\n", "columns", "no header"),
    ("1,2,3,0,0,0\n", "columns", "x,y,z,rx,ry,rz"),
    ("x [ft],y,z\n1,2,3\n", "line 1, column x [ft]", "unit 'ft' is not known: m, mm"),
    ("x,y,z,qx [rad],qy,qz,qw\n1,2,3,0,0,0,1\n", "line 1, column qx [rad]", "unit 'rad'"),
    ("x_mm,y_m,z_mm\n1,2,3\n", "units", "different units"),
    ("x,y,z\n1,2,5.5\n", "units", "metres or millimetres"),
    ("x,y,z,roll,pitch,yaw\n1,2,3,0,0,5\n", "angles", "radians or degrees"),
    ("x,y,z,rx,ry,rz\n1,2,3,0,90,0\n", "angles", "--columns x,y,z,roll,pitch,yaw"),
    ("x,y,z,rx [deg],ry [deg],rz [deg]\n1,2,3,0,1,0\n", "angles", "rotation vector"),
    ("x,y,z\n", "line 1", "no point follows"),
    ("\n", "line 1", "no line with values"),
    ("x,y,z\n1,2,3\n\n1,2\n", "line 4", "2 values for 3 columns"),
    ("x,y,z\n1,2,3\n0,5,0,2,0,3\n", "line 3", "decimal commas need another separator"),
    ("x,y,z\n1,2,three\n", "line 2, column z", "'three' is not a finite number"),
    ("x,y,z\n1,2,\n", "line 2, column z", "the cell is empty"),
    ("x,y,z\n1,nan,3\n", "line 2, column y", "'nan' is not a finite number"),
    ("x,y,z\n1,1e999,3\n", "line 2, column y", "'1e999' is not a finite number"),
    ("x;y;z\n1,5;2.5;0\n", "line 2", "decimal comma"),
    ("x;y;z\n1.234,5;2;0\n", "line 2, column x", "'1.234,5' is not a finite number"),
    ("# c\nx,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,3,0,0,0,2\n", "line 4, column qx, qy, qz, qw",
     "norm 1, not 2"),
    ("x,y,z,qx,qy,qz,qw\n1,2,3,0,,0,1\n", "line 2, column qy", "the cell is empty"),
    ("x,y,z,i,j,k\n1,2,3,0,0,0\n", "line 2, column i, j, k", "a tool axis has length 1, not 0"),
    (",".join("abc"[k % 3] * (k + 1) for k in range(401)) + "\n", "line 1", "401 columns"),
    ("x,y," + "z" * 201 + "\n1,2,3\n", "line 1", "more than 200 characters"),
    ("x,y,z,feed\n1,2,3,100\n", "line 2, column feed", "needs a unit"),
    ("x,y,z,speed\n0.4,0,0.3,250\n", "line 2, column speed", "the highest speed is 250 m/s"),
    ("x_mm,y,z,v\n400,0,300,0.25\n", "line 2, column v", "the highest speed is 0.00025 m/s"),
    ("x,y,z,speed\n1,2,3,-1\n", "line 2, column speed", "above 0"),
    ("x,y,z,speed [%]\n1,2,3,150\n", "line 2, column speed [%]", "at most 100 %"),
    ("x,y,z,zone\n1,2,3,CNT100\n", "line 2, column zone", "not a finite number"),
    ("x,y,z,j1,j2\n1,2,3,0,0\n", "line 1", "positions and joint values (j1, j2)"),
    ("j1,j3\n1,2\n", "line 1", "without a gap"),
    ("x,y,z\n2000000,0,0\n".replace("x,y,z", "x_m,y_m,z_m"), "line 2", "beyond 1e+06 m"),
]  # fmt: skip
"""Files that are refused: the field named, and words of why."""
