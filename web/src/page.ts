/** The page's one liberty: `?src=other.rbn` shows another file than scene.rbn. */

const src = new URLSearchParams(location.search).get("src");
if (src) document.querySelector("rebounce-viewer")?.setAttribute("src", src);

export {};
