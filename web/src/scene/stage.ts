/** The 3D view: camera, light and ground. Drawn only when something has changed. */

import {
  Box3, DirectionalLight, GridHelper, Group, HemisphereLight, Mesh, Object3D, PCFShadowMap,
  PerspectiveCamera, PlaneGeometry, Raycaster, Scene, ShadowMaterial, Sphere, SRGBColorSpace, Vector2,
  Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import { onPaletteChange, palette } from "./palette";

export type View = "fit" | "front" | "side" | "top";

const DIRECTIONS: Record<View, Vector3> = {
  fit: new Vector3(1.0, -1.15, 0.72),
  front: new Vector3(1, 0, 0.12),
  side: new Vector3(0, -1, 0.12),
  top: new Vector3(0.001, 0, 1),
};

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(32, 1, 0.01, 100);
  private readonly ground = new Group();
  private readonly sun = new DirectionalLight("#ffffff", 2.2);
  private readonly renderer: WebGLRenderer;
  readonly orbit: OrbitControls;
  readonly canvas: HTMLCanvasElement;
  private readonly fine: boolean;
  private pending = false;
  private touched = false;
  private readonly drawn: (() => void)[] = [];

  /** Throws if the browser cannot draw in 3D. */
  constructor(readonly host: HTMLElement) {
    this.fine = location.search === "?fine" || !drawsInSoftware();
    this.renderer = new WebGLRenderer({ antialias: this.fine });
    this.renderer.outputColorSpace = SRGBColorSpace;
    this.renderer.shadowMap.enabled = this.fine;
    this.renderer.shadowMap.type = PCFShadowMap;
    const canvas = this.renderer.domElement;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The arm and the path of its tool");
    host.prepend(canvas);
    this.canvas = canvas;

    this.camera.up.set(0, 0, 1); // as robots have it
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.addEventListener("change", this.draw);
    this.orbit.addEventListener("start", () => { this.touched = true; });
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 4;
    this.sun.shadow.bias = -0.0005;
    this.sun.shadow.normalBias = 0.004;
    this.scene.add(this.sun, this.sun.target, new HemisphereLight("#ffffff", "#8a8f96", 1.6), this.ground);
    this.paint();
    onPaletteChange(() => this.paint());
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  /** Asks for a new picture; many askings make one. */
  readonly draw = (): void => {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.renderer.render(this.scene, this.camera);
      for (const listener of this.drawn) listener();
    });
  };

  /** Hears of every picture. */
  onDrawn(listener: () => void): void {
    this.drawn.push(listener);
  }

  /** The view of now as a picture, PNG in a data address. */
  picture(): string {
    this.renderer.render(this.scene, this.camera);
    return this.canvas.toDataURL("image/png");
  }

  /** Hears of a click on the picture that was no drag, as a ray into the scene. */
  onClick(listener: (ray: Raycaster) => void): void {
    let from: [number, number] | null = null;
    this.canvas.addEventListener("pointerdown", (event) => { from = [event.clientX, event.clientY]; });
    this.canvas.addEventListener("pointerup", (event) => {
      if (from === null || Math.hypot(event.clientX - from[0], event.clientY - from[1]) > 3) return;
      const box = this.canvas.getBoundingClientRect();
      const ray = new Raycaster();
      ray.setFromCamera(new Vector2(
        ((event.clientX - box.left) / box.width) * 2 - 1,
        1 - ((event.clientY - box.top) / box.height) * 2,
      ), this.camera);
      listener(ray);
    });
  }

  /** Looks at content that has changed, unless the user has chosen how to look. */
  follow(content: Object3D[]): void {
    if (!this.touched) this.look("fit", content);
  }

  /** Puts the ground under what is shown, and the camera where all of it is seen. */
  look(view: View, content: Object3D[]): void {
    this.touched = view !== "fit";
    const box = new Box3();
    for (const object of content) box.expandByObject(object);
    if (box.isEmpty()) box.set(new Vector3(-0.5, -0.5, 0), new Vector3(0.5, 0.5, 1));
    this.ground.position.z = Math.min(0, box.min.z) - 0.001;
    const sphere = box.getBoundingSphere(new Sphere());
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(1, this.camera.aspect);
    const distance = (sphere.radius * 0.86) / Math.sin(Math.atan(Math.tan(half) * narrow));
    const direction = DIRECTIONS[view].clone().normalize();
    this.camera.position.copy(sphere.center).addScaledVector(direction, distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.orbit.target.copy(sphere.center);
    this.orbit.update();
    this.light(sphere);
    this.draw();
  }

  private light(sphere: Sphere): void {
    this.sun.position.copy(sphere.center).add(
      new Vector3(0.5, -0.9, 2.2).multiplyScalar(2 * sphere.radius),
    );
    this.sun.target.position.copy(sphere.center);
    const camera = this.sun.shadow.camera;
    camera.left = camera.bottom = -1.6 * sphere.radius;
    camera.right = camera.top = 1.6 * sphere.radius;
    camera.near = 0.1 * sphere.radius;
    camera.far = 12 * sphere.radius;
    camera.updateProjectionMatrix();
  }

  private paint(): void {
    const colours = palette();
    this.scene.background = colours.ground;
    for (const old of this.ground.children as Mesh[]) old.geometry.dispose();
    this.ground.clear();
    for (const [size, parts, colour, z] of [
      [6, 60, colours.gridFine, -0.0004],
      [6, 12, colours.gridCoarse, 0],
    ] as const) {
      const grid = new GridHelper(size, parts, colour, colour);
      grid.rotation.x = Math.PI / 2;
      grid.position.z = z;
      this.ground.add(grid);
    }
    const shade = new Mesh(new PlaneGeometry(6, 6), new ShadowMaterial({ opacity: 0.18 }));
    shade.receiveShadow = true;
    this.ground.add(shade);
    this.draw();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(this.fine ? Math.min(devicePixelRatio, 2) : 1);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }
}

/** Whether there is no graphics processor: then smooth edges and shadows would cost the motion. */
function drawsInSoftware(): boolean {
  const probe = document.createElement("canvas").getContext("webgl2");
  if (probe === null) return true;
  const info = probe.getExtension("WEBGL_debug_renderer_info");
  const name = String(probe.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? probe.RENDERER));
  probe.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
