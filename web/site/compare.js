// The comparison: two pictures, one over the other, up to a line that a slider moves.

const find = (id) => document.getElementById(id);
const at = find("at");
const pair = find("compare").querySelector(".pair");
const pictures = [...document.querySelectorAll("#pictures figure")].map((figure) => ({
  name: figure.dataset.name,
  image: figure.querySelector("img"),
}));
const chosen = { left: 0, right: 1 };

function show() {
  for (const side of ["left", "right"]) {
    const { name, image } = pictures[chosen[side]];
    find(side).src = image.src;
    find(side).className = image.className;
    find(`${side}-tag`).textContent = name;
  }
  pair.style.setProperty("--at", `${at.value}%`);
  const [left, right] = [pictures[chosen.left].name, pictures[chosen.right].name];
  at.setAttribute("aria-label", `Line between ${left} (left) and ${right} (right)`);
  at.setAttribute("aria-valuetext", `${left} up to ${at.value} percent, then ${right}`);
}

for (const side of ["left", "right"]) {
  pictures.forEach(({ name }, i) => {
    const input = document.createElement("input");
    input.type = "radio";
    input.name = side;
    input.checked = chosen[side] === i;
    input.addEventListener("change", () => {
      chosen[side] = i;
      show();
    });
    const label = document.createElement("label");
    label.append(input, name);
    find(`${side}-choices`).append(label);
  });
}
at.addEventListener("input", show);
show();
find("compare").hidden = false;
