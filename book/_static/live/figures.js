// Plotly's figures, drawn by the book's own copy of plotly.js in the colours of the page.

{
  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /** The figure's layout with the page's paper, ink and grid. */
  function themed(layout) {
    const [ink, grid] = [style("--pst-color-text-base"), style("--pst-color-border")];
    const axes = Object.keys(layout).filter((name) => /^[xy]axis\d*$/.test(name));
    const colours = { gridcolor: grid, zerolinecolor: grid, linecolor: grid };
    const themedAxes = Object.fromEntries([...new Set([...axes, "xaxis", "yaxis"])].map((name) => [name, { ...layout[name], ...colours }]));
    const clear = "rgba(0,0,0,0)";
    return { ...layout, ...themedAxes, paper_bgcolor: clear, plot_bgcolor: clear, font: { ...layout.font, color: ink }, autosize: true };
  }

  /** Draw a figure, again whenever the page changes between light and dark. */
  Live.drawFigure = (node, figure) => {
    node.figure = figure;
    const draw = () => Plotly.react(node, node.figure.data, themed(node.figure.layout ?? {}), { responsive: true, displaylogo: false });
    if (!node.watched) new MutationObserver(draw).observe(document.documentElement, { attributeFilter: ["data-theme"] });
    node.watched = true;
    return draw();
  };

  /** The view of a figure that is a widget: its figure comes with the records. */
  Live.figureView = (model) => {
    const node = Live.element("div", { class: "live-plot" });
    const show = () => { if (model.get("figure")) Live.drawFigure(node, JSON.parse(model.get("figure"))); };
    model.on("change:figure", show);
    requestAnimationFrame(show); // once it stands in the page and has a width
    return node;
  };
}
