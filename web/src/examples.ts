/** The examples of the checkout, part of the bundle. */

import beyond from "../../examples/beyond_reach_xarm7.json";
import curve from "../../examples/curve_ur5.json";
import helix from "../../examples/helix_iiwa14.json";
import lines from "../../examples/lines_panda.json";
import type { Request } from "./documents";

export const EXAMPLES: { name: string; title: string; request: Request }[] = [
  { name: "helix_iiwa14", title: "Helix, iiwa14", request: helix },
  { name: "lines_panda", title: "Lines with rounded corners, panda", request: lines },
  { name: "curve_ur5", title: "Circle and line, jerk limited, ur5", request: curve },
  { name: "beyond_reach_xarm7", title: "Out of reach, with a repair, xarm7", request: beyond },
];
