/** The arm as the user moves it: by joints, or after a pose that it follows by the service's IK. */

import { isNumbers, type Problem, type Request, type RobotInfo } from "../documents";
import type { Pose } from "../path/items";
import { Refusal, solvePose } from "../service";
import type { ArmView } from "../view";

/** Two configurations that differ by more are not the same [rad or m]. */
const SAME = 1e-3;

export class LiveArm {
  q: number[] = [];
  /** Where the tool has been told to go last, in the base; null: the joints have been set since. */
  goal: Pose | null = null;
  private robot: RobotInfo | null = null;
  private wanted: { pose: Pose; own: boolean } | null = null;
  private asking = false;
  private readonly listeners: (() => void)[] = [];

  /** `request` is the document, for the tool and the scene. */
  constructor(private readonly view: ArmView, private readonly request: () => Request | null) {}

  onMove(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Takes another robot, or another place for it, without asking anything. */
  take(robot: RobotInfo, q: number[]): void {
    this.robot = robot;
    this.q = q;
    this.wanted = null;
    this.goal = null;
    this.view.setFault("");
    for (const listener of this.listeners) listener();
  }

  /** Shows joint values that the user sets, and asks whether they touch anything. */
  setJoints(q: number[]): void {
    this.goal = null;
    this.put(q);
    this.view.setFault("");
    this.ask(this.view.toolPose(), true);
  }

  /** Lets the tool follow a pose in the base; the last one asked for is the one it ends at. */
  follow(pose: Pose): void {
    this.goal = pose;
    this.ask(pose, false);
  }

  private put(q: number[]): void {
    this.q = q;
    this.view.setJoints(q);
    for (const listener of this.listeners) listener();
  }

  private ask(pose: Pose, own: boolean): void {
    this.wanted = { pose, own };
    if (!this.asking) void this.run();
  }

  private async run(): Promise<void> {
    this.asking = true;
    this.view.setBusy(true);
    try {
      while (this.wanted !== null) {
        const { pose, own } = this.wanted;
        this.wanted = null;
        await this.solve(pose, own);
      }
    } finally {
      this.asking = false;
      this.view.setBusy(false);
    }
  }

  private async solve(pose: Pose, own: boolean): Promise<void> {
    const robot = this.robot;
    const request = this.request();
    if (robot === null || request === null) return;
    const start = this.q;
    try {
      const q = await solvePose(robot.name, request, pose, start, false);
      if (this.robot !== robot) return;
      const other = q.some((value, j) => Math.abs(value - start[j]!) > SAME);
      if (own && other) this.view.setFault("This configuration is in contact; others with this pose are not.");
      else if (!own) this.put(q);
      if (!(own && other)) this.view.setFault("");
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (this.robot !== robot) return;
      this.view.setFault(error.problem.title);
      if (this.wanted === null) await this.explain(robot, request, pose, own);
    }
  }

  /** Asks again for the reason, which takes longer, once the user holds still. */
  private async explain(robot: RobotInfo, request: Request, pose: Pose, own: boolean): Promise<void> {
    try {
      await solvePose(robot.name, request, pose, this.q, true);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (this.robot !== robot || this.wanted !== null) return;
      this.view.setFault(reasonOf(error.problem));
      if (!own && isNumbers(error.problem.q, this.q.length)) this.put(error.problem.q);
    }
  }
}

function reasonOf(problem: Problem): string {
  return `${problem.title}: ${problem.detail}`;
}
