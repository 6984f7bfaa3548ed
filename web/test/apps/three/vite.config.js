export default { optimizeDeps: { exclude: ["rebounce-viewer"] }, build: { target: "es2022" } };
