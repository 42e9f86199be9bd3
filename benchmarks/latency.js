// From the hand to the picture: one interaction at a time, timed by the page itself.
//
// The clock starts with the time stamp of the event that the hand caused, so waiting in the page's
// queue counts. It stops in the first task after the frame in which the new picture was painted:
// what the compositor does afterwards, outside of the page, is not seen.
window.latency = (() => {
  const DRAWING = ["fillRect", "fillText", "stroke", "fill"];
  const { port1, port2 } = new MessageChannel();
  const waiting = [];
  port1.onmessage = () => waiting.splice(0).forEach((done) => done(performance.now()));
  const afterPaint = (done) => { waiting.push(done); port2.postMessage(0); };

  let now = null; // the interaction that is being timed
  const finish = () => {
    const { started, done } = now;
    now = null;
    afterPaint((end) => done(end - started));
  };
  const hear = (event) => {
    if (now && now.started === null && now.events.includes(event.type)) now.started = event.timeStamp;
  };
  for (const type of ["pointermove", "pointerup", "input", "keydown"]) window.addEventListener(type, hear, true);

  // Our widgets draw within the frame that is painted next: no need to wait for another one.
  for (const name of DRAWING) {
    const draw = CanvasRenderingContext2D.prototype[name];
    CanvasRenderingContext2D.prototype[name] = function (...given) {
      if (now && now.started !== null && this.canvas === now.canvas) {
        const answered = name === "fillText" && `${given[0]}`.startsWith("answer ") && given[0] !== now.said;
        if (answered) window.latency.said = given[0];
        if (now.sees === "canvas" || (now.sees === "answer" && answered)) finish();
      }
      return draw.apply(this, given);
    };
  }

  // Whatever is changed in the document is painted with the next frame.
  const watch = (node) => {
    const observer = new MutationObserver(() => {
      if (!now || now.started === null) return;
      observer.disconnect();
      const mine = now;
      requestAnimationFrame(() => { if (now === mine) finish(); });
    });
    observer.observe(node, { subtree: true, childList: true, attributes: true, characterData: true });
  };

  return {
    said: "",
    /** Get ready for one interaction: which events start it, where to look, what to look for. */
    arm(selector, sees, events) {
      const node = document.querySelector(selector);
      const time = new Promise((done) => {
        now = { started: null, done, sees, events, canvas: sees === "page" ? null : node, said: this.said };
      });
      if (sees === "page") watch(node);
      const late = new Promise((resolve) => setTimeout(() => resolve(null), 20000));
      this.time = Promise.race([time, late]);
    },
  };
})();
