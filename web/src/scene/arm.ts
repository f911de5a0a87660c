/** A robot in the scene: set its joints, and ask where its tool is. */

import { Box3, Color, Group, Mesh, MeshPhongMaterial, MeshStandardMaterial, Object3D, Quaternion, Vector3 } from "three";
import URDFLoader, { type URDFJoint, type URDFRobot } from "urdf-loader";

import type { RobotInfo } from "../documents";
import type { Target } from "../targets";
import { poseOfMatrix } from "../path/frames";
import type { Pose } from "../path/items";
import { loadMesh, plain } from "./meshes";
import { palette } from "./palette";
import { drawSkeleton } from "./skeleton";

const BLACK = new Color(0);

export class Arm {
  /** Has the robot's base at its origin. */
  readonly root = new Group();
  /** The tool frame. */
  readonly tool = new Group();
  /** The tip frame, which the tool is in. */
  readonly tip = new Group();
  /** Ends when the meshes are there; says how many could not be had. */
  readonly complete: Promise<number>;
  /** The joint values shown. */
  joints: number[] = [];
  private readonly robot: URDFRobot;
  private readonly serial: URDFJoint[];
  private skeleton: Object3D[] = [];

  constructor(readonly info: RobotInfo, urdf: string) {
    const meshes: Promise<boolean>[] = [];
    const loader = new URDFLoader();
    loader.loadMeshCb = (address, _manager, material, done) => {
      const { color, opacity } = material as MeshPhongMaterial;
      meshes.push(
        loadMesh(address, color ?? new Color("#c8ced4"), opacity).then(
          (object) => (done(object), true),
          () => false,
        ),
      );
    };
    this.robot = loader.parse(urdf);
    this.root.add(this.robot);
    const names = info.coupling?.serial ?? info.joints.map((joint) => joint.name);
    this.serial = names.map((name) => this.robot.joints[name]!);
    for (const joint of this.serial) joint.ignoreLimits = true; // the plan keeps them
    this.link(info.tip_frame).add(this.tool, this.tip);
    this.setTool(null);
    this.placeBase();
    if (!this.finishShapes() && meshes.length === 0) this.showSkeleton();
    this.complete = this.load(meshes);
  }

  /** Shows joint values, shape (dof,) [rad or m]. */
  setJoints(q: number[]): void {
    this.joints = q;
    const coupling = this.info.coupling;
    for (const [i, joint] of this.serial.entries()) {
      const value = coupling === null
        ? q[i]!
        : coupling.matrix[i]!.reduce((sum, m, j) => sum + m * q[j]!, coupling.offset[i]!);
      joint.setJointValue(value);
    }
  }

  /** Gives the arm the tool of a request; null: its own. */
  setTool(tool: Target | null): void {
    this.tool.position.copy(tool?.position ?? new Vector3(...this.info.tool_position));
    this.tool.quaternion.copy(
      tool?.quaternion ?? new Quaternion(...(this.info.tool_quaternion_xyzw as [number, number, number, number])),
    );
    if (this.skeleton.length > 0) this.showSkeleton();
  }

  /** Where the tool is in the base, as the scene has it [m]. */
  toolPosition(): Vector3 {
    return this.tool.getWorldPosition(new Vector3());
  }

  /** The pose of the tool in the base. */
  toolPose(): Pose {
    this.tool.updateWorldMatrix(true, false);
    return poseOfMatrix(this.tool.matrixWorld);
  }

  /** Makes the whole arm red, or as it was. */
  setFault(fault: boolean): void {
    this.root.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      for (const material of [part.material].flat()) {
        if (material instanceof MeshStandardMaterial || material instanceof MeshPhongMaterial) {
          material.emissive.copy(fault ? palette().fault : BLACK);
          material.emissiveIntensity = fault ? 0.65 : 1;
        }
      }
    });
  }

  /** From corner to corner of all there is to see of the robot [m]. */
  size(): number {
    return new Box3().setFromObject(this.root).getSize(new Vector3()).length();
  }

  private link(name: string): Object3D {
    const found = this.robot.links[name];
    if (found === undefined) throw new Error(`the visual of ${this.info.name} has no link ${name}`);
    return found;
  }

  private placeBase(): void {
    const base = this.link(this.info.base_frame);
    this.root.updateMatrixWorld(true);
    this.robot.applyMatrix4(base.matrixWorld.clone().invert());
    this.root.updateMatrixWorld(true);
  }

  /** Every joint from base to tip. */
  private chain(): URDFJoint[] {
    const base = this.link(this.info.base_frame);
    const joints: URDFJoint[] = [];
    for (let at: Object3D | null = this.tool.parent; at !== null && at !== base; at = at.parent) {
      if ("isURDFJoint" in at) joints.unshift(at as URDFJoint);
    }
    return joints;
  }

  private showSkeleton(): void {
    for (const part of this.skeleton) part.removeFromParent();
    this.skeleton = drawSkeleton(this.chain(), this.tool);
  }

  /** Gives boxes, cylinders and spheres the finish of meshes; says whether there are any. */
  private finishShapes(): boolean {
    let any = false;
    this.robot.traverse((part) => {
      any ||= part instanceof Mesh;
      if (part instanceof Mesh && part.material instanceof MeshPhongMaterial) {
        part.material = plain(part.material.color, part.material.opacity);
      }
      part.castShadow = part.receiveShadow = part instanceof Mesh;
    });
    return any;
  }

  private async load(meshes: Promise<boolean>[]): Promise<number> {
    if (meshes.length === 0) return 0;
    const had = await Promise.all(meshes);
    this.robot.traverse((part) => {
      part.castShadow = part.receiveShadow = part instanceof Mesh;
    });
    const missing = had.filter((ok) => !ok).length;
    if (missing === meshes.length) this.showSkeleton();
    return missing;
  }
}
