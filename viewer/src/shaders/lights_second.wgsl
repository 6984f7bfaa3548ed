// The bind group of the lights.

const LIGHTS = 1;
