import "rebounce-viewer";
import type { Light, RebounceViewer } from "rebounce-viewer";
import type {} from "rebounce-viewer/react";
import { StrictMode, useRef, useState } from "react";
import { createRoot } from "react-dom/client";

const LAMP: Light[] = [{ type: "point", position: [0, 4, -2.8], intensity: 40, color: [1, 0.8, 0.6] }];

function App() {
  const viewer = useRef<RebounceViewer>(null);
  const [told, setTold] = useState("nothing yet");
  return (
    <main>
      <rebounce-viewer
        ref={viewer}
        src="scene.rbn"
        alt="A box with a red and a green wall"
        controls
        lights={LAMP}
        onload={(event) => setTold(`${event.detail.url}: ${viewer.current?.lights.length} light`)}
        onerror={(event) => setTold(event.detail.message)}
      />
      <output>{told}</output>
    </main>
  );
}

export const mistakes = [
  // @ts-expect-error: there is no such mode
  <rebounce-viewer key="mode" mode="bright" />,
  // @ts-expect-error: a method is no property to set
  <rebounce-viewer key="reload" reload={() => undefined} />,
  // @ts-expect-error: React's own onLoad never comes
  <rebounce-viewer key="load" onLoad={() => undefined} />,
];

createRoot(document.getElementById("root")!).render(
  <StrictMode>
    <App />
  </StrictMode>,
);
