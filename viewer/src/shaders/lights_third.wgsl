// The bind group of the lights where there are materials, too.

const LIGHTS = 2;
