// How long a frame takes on this device, in place of what was measured when the page was built.

const words = document.getElementById("frame-words");

for (const viewer of document.querySelectorAll("rebounce-viewer")) {
  const cell = viewer.closest("li").querySelector("[data-frame]");
  let waiting = 0;
  const tell = () => {
    waiting = 0;
    const times = Object.values(viewer.stats()?.milliseconds ?? {});
    const sum = times.reduce((all, one) => all + one, 0);
    // Some devices do not tell.
    if (!sum) return;
    cell.textContent = `${sum < 9.95 ? sum.toFixed(1) : Math.round(sum)} ms here`;
    words.textContent = "measured in this browser, on your device, where it says “here”";
  };
  const later = () => (waiting ||= setTimeout(tell, 500));
  for (const type of ["load", "light-change", "camera-change"]) viewer.addEventListener(type, later);
}
