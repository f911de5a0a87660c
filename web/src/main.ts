/** The page: what belongs to what. */

import { Clock } from "./clock";
import type { Plan, Problem, Repair, Request, RobotInfo } from "./documents";
import { isNumbers } from "./documents";
import { byId, h } from "./dom";
import { EXAMPLES } from "./examples";
import { makePlan } from "./job";
import { limitsOf } from "./limits";
import { bindingPanel } from "./panels/binding";
import { certificatePanel } from "./panels/certificate";
import { downloadPanel } from "./panels/downloads";
import { Editor } from "./panels/editor";
import { Plots } from "./panels/plots";
import { ProgressPanel } from "./panels/progress";
import { Transport } from "./panels/transport";
import { keyPanel, verdictPanel } from "./panels/verdict";
import { Motion } from "./playback";
import { Refusal, accessKey, fetchRobots } from "./service";
import { failedTargets, targetsOf, toolOf } from "./targets";
import { setAngleUnit, timeText, type AngleUnit } from "./units";
import { ArmView } from "./view";

interface Planned {
  request: Request;
  document: string;
  plan: Plan;
  text: string;
  motion: Motion;
  robot: RobotInfo;
}

const result = byId("result");
const status = byId("status");
const planButton = byId<HTMLButtonElement>("plan");
let robots: RobotInfo[] = [];
let planned: Planned | null = null;
let refused: { problem: Problem; retryAfter: string | null; request: Request } | null = null;
let underway: AbortController | null = null;

const clock = new Clock(showMoment);
const transport = new Transport(clock);
const progress = new ProgressPanel((stage) => { status.textContent = stage; });
const view = new ArmView(() => void redraw());
const plots = new Plots(byId("plots"), (time) => clock.seek(time));
const editor = new Editor((request) => void preview(request), () => void plan());

function showMoment(): void {
  transport.update();
  if (planned === null) return;
  const moment = planned.motion.at(clock.time);
  view.setJoints(moment.q);
  view.setPassed(planned.motion.index(clock.time));
  view.setTime(clock.time);
  plots.update(clock.time, moment);
}

/** Shows what a document asks for, before it is planned. */
async function preview(request: Request): Promise<void> {
  if (planned !== null && planned.document === editor.document) return;
  const robot = robots.find(({ name }) => name === request["robot"]);
  if (robot === undefined) return;
  forget();
  result.replaceChildren(h("p", { class: "empty" }, "Plan to see the motion, its certificate and its limits."));
  await place(robot, request);
}

function forget(): void {
  planned = null;
  refused = null;
  plots.clear();
  transport.show(null);
  clock.reset(0);
}

/** Puts the robot at its start and marks the poses asked for. */
async function place(robot: RobotInfo, request: Request): Promise<boolean> {
  try {
    if ((await view.showRobot(robot)) === null) return false;
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    showRefusal(error, request);
    return false;
  }
  view.setTool(toolOf(request));
  view.clearMarks();
  view.showSurroundings(request);
  const start = request["start"];
  const q = isNumbers(start, robot.joints.length) ? start : robot.joints.map((joint) => joint.home);
  view.setJoints(q);
  view.markWaypoints(targetsOf(request).flatMap((target) => target?.position ?? []));
  return true;
}

async function plan(): Promise<void> {
  if (underway !== null) {
    underway.abort();
    return;
  }
  const request = editor.request();
  if (request === null) return;
  const document = editor.document;
  underway = new AbortController();
  planButton.textContent = "Cancel";
  progress.begin();
  result.setAttribute("aria-busy", "true");
  try {
    const { plan: made, text } = await makePlan(document, underway.signal, (how) => progress.show(how));
    const robot = robots.find(({ name }) => name === made.robot);
    if (robot === undefined) throw new Error(`the service planned for ${made.robot}, which it does not list`);
    await showPlan({ request, document, plan: made, text, motion: new Motion(made.trajectory), robot });
  } catch (error) {
    if (error instanceof Refusal) await showVerdict(error, request);
    else if (error instanceof DOMException) status.textContent = "Cancelled";
    else throw error;
  } finally {
    underway = null;
    progress.end();
    planButton.textContent = "Plan";
    result.removeAttribute("aria-busy");
  }
}

async function showPlan(made: Planned): Promise<void> {
  forget();
  planned = made;
  if (!(await place(made.robot, made.request))) return;
  drawPlan(made);
  describe();
  transport.show(made.motion);
  clock.reset(made.motion.duration);
  view.follow();
  status.textContent = `There is a plan of ${timeText(made.motion.duration)}`;
}

function drawPlan({ plan: made, motion, request }: Planned): void {
  view.clearMarks();
  view.showSurroundings(request);
  view.markNearest(made.certificate.clearance);
  view.markTrace(view.toolPositions(motion.samples.q));
  view.markWaypoints(view.toolPositions(made.waypoints.q));
}

async function showVerdict(refusal: Refusal, request: Request): Promise<void> {
  forget();
  showRefusal(refusal, request);
  const robot = robots.find(({ name }) => name === request["robot"]);
  if (robot !== undefined && (await place(robot, request))) drawVerdict(refusal.problem, request, robot);
}

function showRefusal({ problem, retryAfter }: Refusal, request: Request): void {
  refused = { problem, retryAfter, request };
  status.textContent = `No plan: ${problem.title}`;
  describe();
}

function drawVerdict(problem: Problem, request: Request, robot: RobotInfo): void {
  const q = isNumbers(problem.q, robot.joints.length) ? problem.q : null;
  const targets = failedTargets(problem, request);
  const stuck = q !== null && problem.waypoint === undefined;
  if (stuck) {
    // No pose failed, but the way to it: what failed is where the tool is then.
    view.markFailures([...view.toolPositions([q]).map((position) => ({ position, quaternion: null })), ...targets], null);
  } else {
    view.markFailures(targets, q);
  }
  if (q !== null) view.setJoints(q);
  view.follow();
}

/** Writes the result, in the units chosen. */
function describe(): void {
  if (refused !== null) {
    const { problem, retryAfter } = refused;
    result.replaceChildren(problem.status === 401
      ? keyPanel(problem, (key) => { accessKey.set(key); void begin(); })
      : verdictPanel(problem, retryAfter, applyRepair));
  } else if (planned !== null) {
    const { plan: made, request, text, robot } = planned;
    const cards = [certificatePanel(made, request, (time) => clock.seek(time)), downloadPanel(made, text)];
    if (made.timing !== null) cards.splice(1, 0, bindingPanel(made.timing));
    result.replaceChildren(...cards);
    plots.show(made, limitsOf(robot, request));
  }
}

function applyRepair(repair: Repair): void {
  editor.apply(repair.change);
  void plan();
}

/** Draws everything again in the colours of now. */
async function redraw(): Promise<void> {
  if (planned !== null) {
    drawPlan(planned);
    showMoment();
  } else if (refused === null) {
    const request = editor.request();
    if (request !== null) await preview(request);
  }
}

for (const button of document.querySelectorAll<HTMLButtonElement>("[data-unit]")) {
  button.addEventListener("click", () => {
    setAngleUnit(button.dataset["unit"] as AngleUnit);
    for (const other of document.querySelectorAll<HTMLElement>("[data-unit]")) {
      other.setAttribute("aria-pressed", String(other === button));
    }
    describe();
    showMoment();
  });
}
planButton.addEventListener("click", () => void plan());
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") underway?.abort();
});

async function begin(): Promise<void> {
  try {
    robots = await fetchRobots();
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    showRefusal(error, {});
    return;
  }
  refused = null;
  editor.showRobots(robots);
  editor.useExample(location.hash.slice(1)) || editor.useExample(EXAMPLES[0]!.name);
}

void begin();
