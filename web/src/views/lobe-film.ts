/**
 * Where the lobe is drawn before it is shown: a frame reaches the page only when the graphics card is done with it. A canvas that is drawn to directly holds
 * up the whole page until then, which takes a tenth of a second where there is no graphics card.
 */
import { Camera, Mesh, NoBlending, PlaneGeometry, Scene, ShaderMaterial, type WebGLRenderer, WebGLRenderTarget } from "three";

/** Samples of a pixel, for smooth edges. */
const SAMPLES = 4;
/** How often is looked whether a frame is done, milliseconds. */
const LOOK = 4;
/** After this long a frame is shown, done or not, milliseconds. */
const PATIENCE = 2000;

export class Film {
  private readonly target = new WebGLRenderTarget(1, 1, { samples: SAMPLES });
  private readonly scene = new Scene();
  private readonly camera = new Camera();
  private readonly sheet: Mesh<PlaneGeometry, ShaderMaterial>;

  constructor(private readonly renderer: WebGLRenderer) {
    const material = new ShaderMaterial({
      uniforms: { film: { value: this.target.texture } },
      vertexShader: "varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }",
      fragmentShader: "uniform sampler2D film; varying vec2 at; void main() { gl_FragColor = texture2D(film, at); }",
      blending: NoBlending,
      depthTest: false,
      depthWrite: false,
    });
    this.sheet = new Mesh(new PlaneGeometry(2, 2), material);
    this.sheet.frustumCulled = false;
    this.scene.add(this.sheet);
  }

  dispose(): void {
    this.target.dispose();
    this.sheet.geometry.dispose();
    this.sheet.material.dispose();
  }

  resize(width: number, height: number): void {
    this.target.setSize(width, height);
  }

  /** Compiles what the scene needs, beside everything else. */
  async prepare(scene: Scene, camera: Camera): Promise<void> {
    this.renderer.setRenderTarget(this.target);
    const compiled = this.renderer.compileAsync(scene, camera);
    this.renderer.setRenderTarget(null);
    await Promise.all([compiled, this.renderer.compileAsync(this.scene, this.camera)]);
  }

  expose(scene: Scene, camera: Camera): void {
    this.renderer.setRenderTarget(this.target);
    this.renderer.render(scene, camera);
    this.renderer.setRenderTarget(null);
  }

  show(): void {
    this.renderer.render(this.scene, this.camera);
  }

  /** Calls back when what was exposed is done. */
  whenDone(done: () => void): void {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    const until = performance.now() + PATIENCE;
    gl.flush();
    const look = (): void => {
      // A context that was lost has no fences.
      if (fence !== null && gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED && performance.now() < until) {
        setTimeout(look, LOOK);
        return;
      }
      gl.deleteSync(fence);
      done();
    };
    setTimeout(look);
  }
}
