/** A worker of a bake of a STEP file. */

import init, { SceneFiles, bake } from "../rebounce_baker_step.js";
import { work } from "./work.js";

work({ default: init, SceneFiles, bake });
