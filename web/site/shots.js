// Viewers that name a shot, a camera and lights, begin with it.

for (const viewer of document.querySelectorAll("rebounce-viewer[data-shot]")) {
  fetch(viewer.dataset.shot)
    .then((response) => response.json())
    .then((shot) => (viewer.shot = shot));
}
