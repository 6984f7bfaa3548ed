export default { optimizeDeps: { exclude: ["rebounce-viewer"] } };
