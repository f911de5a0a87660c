/** The page: what belongs to what. */

import { Clock } from "./clock";
import type { Request } from "./documents";
import { byId } from "./dom";
import { JsonEditor } from "./editor/json-editor";
import { EXAMPLES } from "./examples";
import { Outcome } from "./outcome";
import { FileDrop } from "./panels/drop";
import { Editor } from "./panels/editor";
import { History } from "./panels/history";
import { JogPanel } from "./panels/jog";
import { PathList } from "./panels/path-list";
import { Plots } from "./panels/plots";
import { SceneList } from "./panels/scene-list";
import { makeTabs } from "./panels/tabs";
import { Transport } from "./panels/transport";
import { Results } from "./results";
import { MotionView } from "./see/motion-view";
import { Refusal, fetchRobots } from "./service";
import { linkedRequest } from "./state/link";
import { Selection } from "./state/selection";
import { DocumentStore } from "./state/store";
import { setAngleUnit, setLengthUnit, type AngleUnit, type LengthUnit } from "./units";
import { ArmView } from "./view";
import { Workbench } from "./workbench";

/** Where the tab notes which address it has opened. */
const OPENED = "ikplan-opened";
const status = byId("status");

const say = (text: string): void => { status.textContent = text; };
const store = new DocumentStore();
const selection = new Selection();
const results = new Results();
const clock = new Clock(showMoment);
const transport = new Transport(clock);
const view = new ArmView(() => void redraw());
const bench = new Workbench(view, store, selection, (robot) => jog.show(robot));
const { live } = bench;
const plots = new Plots(byId("plots"), (time) => clock.seek(time));
const motion = new MotionView(view, live, plots, clock, results, () => {
  if (store.request !== null) draw(store.request);
});
const points = new PathList(store, selection, () => view.toolPose());
const scene = new SceneList(store, selection, () => beside(view.toolPose().position), () => view.toolPose());
const jog = new JogPanel(live, () => view.toolPose(), (q) => store.edit((request) => ({ ...request, start: q })));
const editor = new Editor(store, (files) => void drop.open(files), tell);
const drop = new FileDrop(store, () => editor, (robot) => {
  if (!bench.robots.some(({ name }) => name === robot.name)) bench.robots = [...bench.robots, robot];
  editor.showRobots(bench.robots);
}, tell);
const text = new JsonEditor(byId("editor"), store, () => void outcome.plan(), () => bench.robots.map(({ name }) => name));

const outcome = new Outcome({
  store, results, view, bench, clock, transport, motion, points, editor, text, say, show, made: () => history.renew(), begin: () => void begin(),
});

const history = new History((id) => void outcome.showKept(id));

store.onChange(() => void show());

/** Where a new obstacle stands: on the ground, to the side of the tool. */
const beside = ([x, y]: number[]): number[] => [Number((x ?? 0.5).toFixed(3)), Number(((y ?? 0) + 0.3).toFixed(3)), 0.1];

/** Says what has been done with a file, so that it is seen. */
function tell(said: string, fault = false): void {
  say(said);
  const line = byId("told");
  line.textContent = said;
  line.classList.toggle("bad", fault);
}

function showMoment(): void {
  transport.update();
  motion.moment();
}

/** Shows the document as it is now. */
async function show(anew = false): Promise<void> {
  const { request } = store;
  outcome.markStale();
  if (request === null) return;
  const robot = bench.robotOf(request);
  if (robot === undefined) return;
  if (results.planned !== null && results.planned.robot !== robot) outcome.forget();
  outcome.invite();
  try {
    if (!(await bench.place(request, anew))) return;
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    outcome.showRefusal(error, request);
    return;
  }
  if (request !== store.request) return; // it has been changed in the meantime
  draw(request);
  bench.hold();
}

/** Draws the path asked for and, where there is one, the motion. */
function draw(request: Request): void {
  view.clearMarks();
  const { planned } = results;
  if (planned !== null) motion.trace(planned);
  if (planned !== null && !results.stale(request)) {
    view.markNearest(planned.plan.certificate.clearance);
    view.markWaypoints(view.toolPositions(planned.plan.waypoints.q));
  } else {
    bench.markPoints(request);
  }
}

/** Draws everything again in the colours of now. */
async function redraw(): Promise<void> {
  await show();
  if (results.planned !== null) motion.plot(results.planned);
  showMoment();
}

/** Writes everything again in the units of now. */
function rewrite(): void {
  outcome.describe();
  view.readout.write();
  points.draw();
  scene.draw();
  const robot = store.request === null ? undefined : bench.robotOf(store.request);
  if (robot !== undefined) jog.show(robot);
  showMoment();
}

for (const button of document.querySelectorAll<HTMLButtonElement>("[data-unit]")) {
  button.addEventListener("click", () => {
    const unit = button.dataset["unit"]!;
    if (unit === "m" || unit === "mm") setLengthUnit(unit as LengthUnit);
    else setAngleUnit(unit as AngleUnit);
    for (const other of button.parentElement!.querySelectorAll("[data-unit]")) {
      other.setAttribute("aria-pressed", String(other === button));
    }
    rewrite();
  });
}
document.querySelectorAll<HTMLElement>("[role=tablist]").forEach(makeTabs);
addEventListener("hashchange", () => void openHash());

/** Opens what the address names: an example, or a request of its own; after a reload the work goes on. */
async function openHash(): Promise<boolean> {
  if (sessionStorage.getItem(OPENED) === location.hash) return false;
  sessionStorage.setItem(OPENED, location.hash);
  const linked = await linkedRequest(location.hash);
  if (linked === null) return editor.useExample(location.hash.slice(1));
  store.write(linked);
  return true;
}

async function begin(): Promise<void> {
  try {
    bench.robots = await fetchRobots();
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    outcome.showRefusal(error, {});
    return;
  }
  results.forget();
  const kept = store.text !== "" || store.restore();
  editor.showRobots(bench.robots);
  if (!(await openHash()) && !kept) editor.useExample(EXAMPLES[0]!.name);
  else await show(true);
  await text.learn();
}

void begin();
