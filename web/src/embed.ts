/** One plan in a document of its own: all that is shown is in it, and nothing is asked of a service. */

import { Clock } from "./clock";
import type { Clearance, Request, RobotInfo, Trajectory } from "./documents";
import { byId } from "./dom";
import { Transport } from "./panels/transport";
import { Motion } from "./playback";
import { Arm } from "./scene/arm";
import { Marks, triad } from "./scene/marks";
import { readMeshesBy } from "./scene/meshes";
import { onPaletteChange } from "./scene/palette";
import { Stage } from "./scene/stage";
import { Surroundings } from "./scene/surroundings";
import { toolOf } from "./targets";

interface Embedded {
  robot: RobotInfo;
  visual: string;
  /** Each mesh in base64, by its address in the visual. */
  meshes: Record<string, string>;
  trajectory: Trajectory;
  waypoints: number[][];
  clearance: Clearance | null;
  /** The tool and the scene of the request. */
  request: Request;
}

const shown = JSON.parse(byId("plan").textContent ?? "") as Embedded;
readMeshesBy((address) => {
  const letters = atob(shown.meshes[address] ?? "");
  return Promise.resolve(Uint8Array.from(letters, (letter) => letter.charCodeAt(0)).buffer);
});

function begin(): void {
  let stage: Stage;
  try {
    stage = new Stage(byId("stage"));
  } catch {
    byId("stage-note").textContent = "This browser cannot draw in 3D (WebGL is off).";
    return;
  }
  const motion = new Motion(shown.trajectory);
  const arm = new Arm(shown.robot, shown.visual);
  const around = new Surroundings();
  const marks = new Marks();
  arm.setTool(toolOf(shown.request));
  arm.tool.add(triad(0.08), around.carried);
  arm.tip.add(around.held);
  stage.scene.add(arm.root, marks.group, around.obstacles);

  const at = (q: number[]) => {
    arm.setJoints(q);
    return arm.toolPosition();
  };
  const draw = (): void => {
    around.show(shown.request);
    around.showNearest(shown.clearance);
    marks.clear();
    marks.showTrace(motion.samples.q.map(at), null);
    marks.showWaypoints(shown.waypoints.map(at), arm.size() * 0.006);
    show();
  };
  const clock = new Clock(() => show());
  const transport = new Transport(clock);
  const show = (): void => {
    transport.update();
    byId("stage").dataset["tool"] = at(motion.at(clock.time).q).toArray().join(" ");
    marks.setPassed(motion.index(clock.time));
    around.setTime(clock.time);
    stage.draw();
  };
  clock.reset(motion.duration);
  transport.show(motion);
  draw();
  onPaletteChange(draw);
  const content = [arm.root, marks.group, around.obstacles];
  stage.follow(content);
  void arm.complete.then(() => {
    stage.follow(content);
    document.body.dataset["meshes"] = "ready";
  });
}

begin();
