import { useLoader } from "@react-three/fiber";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

/** The room, without the lamp of its file. */
export function Room() {
  const { scene } = useLoader(GLTFLoader, "room.glb");
  scene.traverse((object) => object.isLight && (object.visible = false));
  return <primitive object={scene} />;
}
