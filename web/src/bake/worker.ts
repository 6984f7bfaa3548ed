/** A worker of a bake. */

import init, { SceneFiles, bake } from "../rebounce_baker.js";
import { work } from "./work.js";

work({ default: init, SceneFiles, bake });
