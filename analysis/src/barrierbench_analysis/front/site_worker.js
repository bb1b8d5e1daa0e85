// Browsers start no Worker for a page that is read from the disk. There the search runs in a hidden frame that takes the place of one.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.appendChild(this.frame);
      window.addEventListener("message", (event) => {
        if (event.source !== this.frame.contentWindow) return;
        const message = new MessageEvent("message", {data: event.data});
        this.dispatchEvent(message);
        if (this.onmessage) this.onmessage(message);
      });
      this.ready = new Promise((done) => { this.frame.onload = done; });
      const inside = this.frame.contentWindow;
      inside.document.open();
      inside.document.write(`<!doctype html><script>
        postMessage = (data) => parent.dispatchEvent(new MessageEvent("message", {data, source: window}));
        importScripts = (...urls) => urls.reduce((before, url) => before.then(() => new Promise((done) => {
          const script = document.createElement("script");
          script.src = url;
          script.onload = script.onerror = done;
          document.head.appendChild(script);
        })), Promise.resolve());
      </` + `script><script src="${new URL(url, location.href)}"></` + `script>`);
      inside.document.close();
    }
    postMessage(data) {
      this.ready.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", {data})));
    }
    terminate() { this.frame.remove(); }
  };
}
