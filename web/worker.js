// Runs in a worker, after g3r_web.js: the library, one message at a time. Cancelling is ending the worker, from outside.
'use strict';

let library;
let last = {stage: '', time: 0};

// Called by the library, many times a second.
self.g3rProgress = (stage, fraction) => {
  const time = performance.now();
  if (stage === last.stage && time - last.time < 50) return;
  last = {stage, time};
  postMessage({kind: 'progress', stage, fraction});
};

const flag = value => value ? 1 : 0;

const actions = {
  // The module is compiled once, by the page.
  async start({module}) {
    library = await createG3r({
      instantiateWasm(imports, done) {
        WebAssembly.instantiate(module, imports).then(instance => done(instance, module));
        return {};
      },
    });
    postMessage({kind: 'ready'});
  },

  run({name, bytes, mesh, trim, zUp, limited = true}) {
    const path = '/' + name.replace(/[/\0]/g, '_');
    library.FS.writeFile(path, new Uint8Array(bytes), {canOwn: true});
    try {
      const done = library.ccall('web_run', 'number', ['string', 'number', 'number', 'number', 'number'],
                                 [path, flag(mesh), flag(trim), flag(zUp), flag(limited)]);
      if (!done) throw new Error(library.ccall('web_message', 'string'));
    } finally {
      library.FS.unlink(path);
    }
    const start = library._web_page() >>> 0;
    const page = library.HEAPU8.slice(start, start + (library._web_page_size() >>> 0));
    postMessage({kind: 'done', page: page.buffer, report: library.ccall('web_report', 'string')}, [page.buffer]);
  },

  save({name, mesh}) {
    const path = '/' + name;
    if (!library.ccall('web_save', 'number', ['string', 'number'], [path, flag(mesh)])) throw new Error(library.ccall('web_message', 'string'));
    const bytes = library.FS.readFile(path);
    library.FS.unlink(path);
    postMessage({kind: 'saved', name, bytes: bytes.buffer, warnings: library.ccall('web_warnings', 'string')}, [bytes.buffer]);
  },
};

self.onmessage = async event => {
  try {
    await actions[event.data.kind](event.data);
  } catch (error) {
    // What stops the library itself leaves it in no state to go on.
    const broken = !(error instanceof Error) || error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
    postMessage({kind: 'failed', message: String(error && error.message || error), broken});
  }
};
