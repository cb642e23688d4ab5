// What the 3-D view of the pages uses of three.js; esbuild leaves the rest out.
export {
  BackSide, Box3, BufferAttribute, BufferGeometry, CanvasTexture, Color, DataTexture, DoubleSide,
  Float32BufferAttribute, FrontSide, Group, LinearMipmapLinearFilter, Matrix4, Mesh, MeshBasicMaterial, NearestFilter,
  PerspectiveCamera, Scene, ShaderMaterial, SRGBColorSpace, Vector2, Vector3, WebGLRenderer,
} from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
