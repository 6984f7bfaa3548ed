// The sun of a place and an hour as a light. y is up, north is -z, east is +x.

/** Illuminance of the sun above the air, lux. */
const ABOVE_AIR = 133_100;
/** Optical depth of clear air for red, green and blue. */
const DEPTHS = [0.195, 0.237, 0.328];

const radians = (degrees) => (degrees * Math.PI) / 180;

/** The sun at an hour of solar time, at a latitude (degrees), on a day of the year; intensity 0 at night. */
export function sun({ hour, latitude, day = 80, scale = 1 }) {
  const tilt = radians(23.44) * Math.sin((2 * Math.PI * (284 + day)) / 365);
  const turn = radians(15 * (hour - 12));
  const place = radians(latitude);
  const east = -Math.cos(tilt) * Math.sin(turn);
  const north = Math.sin(tilt) * Math.cos(place) - Math.cos(tilt) * Math.sin(place) * Math.cos(turn);
  const up = Math.sin(tilt) * Math.sin(place) + Math.cos(tilt) * Math.cos(place) * Math.cos(turn);
  const mass = 1 / Math.max(up, 0.03);
  const through = DEPTHS.map((depth) => Math.exp(-depth * mass));
  const most = Math.max(...through);
  // The disk sinks below the horizon within a quarter of a degree either way.
  const disk = Math.min(Math.max(0.5 + up / 0.009, 0), 1);
  return {
    type: "directional",
    direction: [-east, -up, north],
    intensity: ABOVE_AIR * most * disk * scale,
    color: through.map((x) => x / most),
  };
}
