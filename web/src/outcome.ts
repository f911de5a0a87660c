/** Planning and its outcome: a plan or a verdict, shown, marked stale, compared, repaired. */

import { isNumbers, type Plan, type Problem, type Repair, type Request, type RobotInfo } from "./documents";
import { byId, h } from "./dom";
import type { JsonEditor } from "./editor/json-editor";
import { makePlan } from "./job";
import { bindingPanel } from "./panels/binding";
import { certificatePanel } from "./panels/certificate";
import { comparePanel } from "./panels/compare";
import { downloadPanel } from "./panels/downloads";
import { forRobot, type Editor } from "./panels/editor";
import type { PathList } from "./panels/path-list";
import { ProgressPanel } from "./panels/progress";
import type { Transport } from "./panels/transport";
import { keyPanel, verdictPanel } from "./panels/verdict";
import type { Clock } from "./clock";
import { Motion } from "./playback";
import type { Planned, Results } from "./results";
import type { MotionView } from "./see/motion-view";
import { Refusal, accessKey, fetchPlan } from "./service";
import type { DocumentStore } from "./state/store";
import { failedTargets } from "./targets";
import { timeText } from "./units";
import type { ArmView } from "./view";
import type { Workbench } from "./workbench";

/** The parts of the page that an outcome is shown in. */
export interface Parts {
  store: DocumentStore;
  results: Results;
  view: ArmView;
  bench: Workbench;
  clock: Clock;
  transport: Transport;
  motion: MotionView;
  points: PathList;
  editor: Editor;
  text: JsonEditor;
  say: (text: string) => void;
  /** Shows the document as it is. */
  show: () => Promise<void>;
  /** Hears that something has been planned. */
  made: () => void;
  /** Begins anew, with the key that was given. */
  begin: () => void;
}

export class Outcome {
  private readonly result = byId("result");
  private readonly button = byId<HTMLButtonElement>("plan");
  private readonly progress: ProgressPanel;
  private underway: AbortController | null = null;

  constructor(private readonly parts: Parts) {
    this.progress = new ProgressPanel(parts.say);
    this.button.addEventListener("click", () => void this.plan());
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.underway?.abort();
    });
  }

  /** Says that there is nothing yet. */
  invite(): void {
    const { planned, refused } = this.parts.results;
    if (planned === null && refused === null) {
      this.result.replaceChildren(h("p", { class: "empty" }, "Plan to see the motion, its certificate and its limits."));
    }
  }

  /** Marks what is no longer of the document. */
  markStale(): void {
    const { planned } = this.parts.results;
    const stale = this.parts.results.stale(this.parts.store.request);
    this.result.dataset["stale"] = String(stale);
    byId("stale").hidden = !stale;
    byId("stale").textContent = planned !== null && !("path" in planned.request)
      ? "This plan is from the history of the service, not of the document."
      : "The document has changed: this result is of the one before.";
    if (stale) this.parts.points.markFailed(null);
  }

  forget(): void {
    const { results, motion, transport, clock, points, text } = this.parts;
    results.forget();
    motion.clear();
    transport.show(null);
    clock.reset(0);
    points.markFailed(null);
    text.mark(null);
  }

  /** Plans, or gives up the plan that is under way. */
  async plan(): Promise<void> {
    if (this.underway !== null) {
      this.underway.abort();
      return;
    }
    const { store, bench, say } = this.parts;
    const { request } = store;
    if (request === null) return;
    this.underway = new AbortController();
    this.button.textContent = "Cancel";
    this.progress.begin();
    this.result.setAttribute("aria-busy", "true");
    try {
      const { plan: made, text } = await makePlan(store.text, this.underway.signal, (how) => this.progress.show(how));
      const robot = bench.robots.find(({ name }) => name === made.robot);
      if (robot === undefined) throw new Error(`the service planned for ${made.robot}, which it does not list`);
      await this.showPlan({ request, plan: made, text, motion: new Motion(made.trajectory), robot });
      this.parts.made();
    } catch (error) {
      if (error instanceof Refusal) await this.showVerdict(error, request);
      else if (error instanceof DOMException) say("Cancelled");
      else throw error;
    } finally {
      this.underway = null;
      this.progress.end();
      this.button.textContent = "Plan";
      this.result.removeAttribute("aria-busy");
    }
  }

  private async showPlan(made: Planned): Promise<void> {
    const { results, motion, transport, clock, view, say, show } = this.parts;
    this.forget();
    results.planned = made;
    await show();
    if (results.planned !== made) return;
    this.describe();
    motion.haunt();
    transport.show(made.motion);
    clock.reset(made.motion.duration);
    view.follow();
    say(`There is a plan of ${timeText(made.motion.duration)}`);
  }

  /** Shows a plan that the service keeps; its request is not known, so it is never that of the document. */
  async showKept(id: string): Promise<void> {
    const { bench, store, say } = this.parts;
    try {
      const text = await fetchPlan(id);
      const plan = JSON.parse(text) as Plan;
      const robot = bench.robots.find(({ name }) => name === plan.robot);
      if (robot === undefined) {
        say(`The robot ${plan.robot} of this plan is no longer listed.`);
        return;
      }
      if (store.request?.["robot"] !== plan.robot) store.edit((request) => forRobot(request, plan.robot));
      await this.showPlan({ request: { robot: plan.robot }, plan, text, motion: new Motion(plan.trajectory), robot });
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      say(error.problem.detail);
    }
  }

  private async showVerdict(refusal: Refusal, request: Request): Promise<void> {
    const { bench, results, show } = this.parts;
    this.forget();
    this.showRefusal(refusal, request);
    await show();
    const robot = bench.robotOf(request);
    if (robot !== undefined && results.refused?.request === request) this.drawVerdict(refusal.problem, request, robot);
  }

  showRefusal({ problem, retryAfter }: Refusal, request: Request): void {
    const { results, say, points, text } = this.parts;
    results.refused = { problem, retryAfter, request };
    say(`No plan: ${problem.title}`);
    points.markFailed(problem);
    text.mark(problem);
    this.describe();
  }

  private drawVerdict(problem: Problem, request: Request, robot: RobotInfo): void {
    const { view, bench } = this.parts;
    const q = isNumbers(problem.q, robot.joints.length) ? problem.q : null;
    const targets = failedTargets(problem, request);
    const stuck = q !== null && problem.waypoint === undefined;
    if (stuck) {
      // No pose failed, but the way to it: what failed is where the tool is then.
      view.markFailures([...view.toolPositions([q]).map((position) => ({ position, quaternion: null })), ...targets], null);
    } else {
      view.markFailures(targets, q);
    }
    if (q !== null) {
      view.setJoints(q);
      bench.live.take(robot, q);
    }
    view.follow();
  }

  /** Writes the result, in the units chosen. */
  describe(): void {
    const { results: { planned, refused, kept }, motion, view, clock, begin } = this.parts;
    if (refused !== null) {
      const { problem, retryAfter } = refused;
      this.result.replaceChildren(problem.status === 401
        ? keyPanel(problem, (key) => { accessKey.set(key); begin(); })
        : verdictPanel(problem, retryAfter, (repair) => this.repair(repair)));
    } else if (planned !== null) {
      const { plan: made, request } = planned;
      this.result.replaceChildren(
        certificatePanel(made, request, (time) => clock.seek(time)),
        ...(made.timing === null ? [] : [bindingPanel(made.timing)]),
        downloadPanel(planned, {
          quantities: () => motion.quantities, picture: () => view.picture(), keep: () => this.compare(planned),
        }),
        ...(kept === null || kept === planned ? [] : [comparePanel(planned, kept, () => this.compare(null))]));
      motion.plot(planned);
    }
    this.markStale();
  }

  /** Keeps a plan to compare those to come with; null: no longer. */
  private compare(kept: Planned | null): void {
    const { results, motion, clock, say, show } = this.parts;
    results.kept = kept;
    if (kept !== null) say("This plan is kept; the next one is compared with it.");
    this.describe();
    motion.haunt();
    void show().then(() => clock.seek(clock.time));
  }

  private repair(repair: Repair): void {
    this.parts.editor.apply(repair.change);
    void this.plan();
  }
}
