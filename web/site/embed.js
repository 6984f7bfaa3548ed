// A button to copy each snippet, where the browser allows that.

if (navigator.clipboard) {
  for (const snippet of document.querySelectorAll("pre")) {
    const box = document.createElement("div");
    box.className = "snippet";
    const button = document.createElement("button");
    button.type = "button";
    button.className = "quiet";
    button.textContent = "Copy";
    button.setAttribute("aria-live", "polite");
    button.addEventListener("click", async () => {
      const copied = navigator.clipboard.writeText(snippet.textContent).then(() => "Copied", () => "Not allowed");
      button.textContent = await copied;
      setTimeout(() => (button.textContent = "Copy"), 2000);
    });
    snippet.replaceWith(box);
    box.append(snippet, button);
  }
}
