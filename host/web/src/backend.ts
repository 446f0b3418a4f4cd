// What answers the page: the server of `arcfeed view`, or arcfeed inside the page, in a worker (host/wasm).

export interface Reply {
    isOk: boolean;
    /** Type of the body. */
    kind: string;
    /** Name for a download. */
    name: string;
    body: Uint8Array<ArrayBuffer>;
}

export interface Backend {
    request(path: string, body?: BodyInit): Promise<Reply>;
    /** Ends what is under way, if anything is. */
    stop(): void;
    /** Address of a file for a frame or a download. */
    address(path: string): Promise<{ url: string; name: string }>;
}

export const text = ({ body }: Reply) => new TextDecoder().decode(body);

/** Server from which the page comes. */
export class Server implements Backend {
    async request(path: string, body?: BodyInit): Promise<Reply> {
        try {
            const answer = await fetch(path, body === undefined ? {} : { method: 'POST', body });
            const kind = answer.headers.get('Content-Type') ?? '';
            return { isOk: answer.ok, kind, name: '', body: new Uint8Array(await answer.arrayBuffer()) };
        } catch {
            throw new Error('No connection to arcfeed: start `arcfeed view` again, and open the address that it prints.');
        }
    }

    stop(): void {
        void fetch('stop', { method: 'POST' });
    }

    address(path: string): Promise<{ url: string; name: string }> {
        return Promise.resolve({ url: `${path}?${Date.now()}`, name: '' });
    }
}

interface Exports {
    memory: WebAssembly.Memory;
    request(bytes: number): number;
    answer(): number;
    reply(): number;
}

/** Code of the worker; it uses nothing from outside of it. */
function work(): void {
    let arcfeed: Promise<Exports>;
    self.onmessage = async ({ data }: MessageEvent) => {
        if (data instanceof WebAssembly.Module) {
            const imports = { page: { now_ms: () => performance.now() } };
            arcfeed = WebAssembly.instantiate(data, imports).then(({ exports }) => exports as unknown as Exports);
            return;
        }
        try {
            const { memory, request, answer, reply } = await arcfeed;
            const asked: Uint8Array = data;
            const at = request(asked.length);
            new Uint8Array(memory.buffer).set(asked, at);
            const bytes = answer();
            self.postMessage(new Uint8Array(memory.buffer).slice(reply(), reply() + bytes));
        } catch (error) {
            self.postMessage(String(error));
        }
    };
}

/** arcfeed inside the page. */
export class InPage implements Backend {
    private worker: Worker;
    /** Ends the wait for an answer. */
    private fail: ((error: Error) => void) | null = null;
    /** The program that a new worker gets. */
    private program: [string, BodyInit] | null = null;
    private urls = new Map<string, string>();
    /** Ends with the last request: the worker gets one after the other. */
    private last: Promise<unknown> = Promise.resolve();

    private constructor(private readonly module: WebAssembly.Module) {
        this.worker = this.start();
    }

    /** Reads the module from the page: base64 of a zlib stream. */
    static async load(base64: string): Promise<InPage> {
        const coded = atob(base64.trim());
        const packed = new Uint8Array(coded.length);
        for (let index = 0; index < packed.length; index++) packed[index] = coded.charCodeAt(index);
        const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
        return new InPage(await WebAssembly.compile(await new Response(stream).arrayBuffer()));
    }

    request(path: string, body?: BodyInit): Promise<Reply> {
        const reply = this.last.then(() => this.ask(path, body));
        this.last = reply.catch(() => {});
        return reply;
    }

    private async ask(path: string, body?: BodyInit): Promise<Reply> {
        const [own, query] = path.split('?');
        if (own === 'program' && body !== undefined) this.program = [path, body];
        const posted = new Uint8Array(await new Response(body ?? '').arrayBuffer());
        const head = new TextEncoder().encode(`${body === undefined ? 'GET' : 'POST'}\n${own}\n${query ?? ''}\n`);
        const asked = new Uint8Array(head.length + posted.length);
        asked.set(head);
        asked.set(posted, head.length);
        const answer = await new Promise<Uint8Array<ArrayBuffer>>((done, failed) => {
            this.fail = failed;
            this.worker.onmessage = ({ data }) => (data instanceof Uint8Array ? done(data as Uint8Array<ArrayBuffer>) : this.broken(data));
            this.worker.postMessage(asked);
        });
        this.fail = null;
        return parse(answer);
    }

    stop(): void {
        if (this.fail) void this.restart('stopped');
    }

    async address(path: string): Promise<{ url: string; name: string }> {
        const { body, kind, name } = await this.request(path);
        URL.revokeObjectURL(this.urls.get(path) ?? '');
        const url = URL.createObjectURL(new Blob([body], { type: kind }));
        this.urls.set(path, url);
        return { url, name };
    }

    /** A fault of arcfeed ends its worker. */
    private broken(words: string): void {
        void this.restart(`A defect of arcfeed: ${words}. Please report it with the program.`);
    }

    /** Ends what is under way; a new worker gets the program. */
    private async restart(words: string): Promise<void> {
        const fail = this.fail;
        this.fail = null;
        this.worker.terminate();
        this.worker = this.start();
        if (this.program && fail) await this.ask(...this.program).catch(() => {});
        fail?.(new Error(words));
    }

    private start(): Worker {
        // As text, so that the policy of the page is that of the worker.
        const code = URL.createObjectURL(new Blob([`(${work})()`], { type: 'text/javascript' }));
        const worker = new Worker(code);
        URL.revokeObjectURL(code);
        worker.postMessage(this.module);
        return worker;
    }
}

function parse(answer: Uint8Array<ArrayBuffer>): Reply {
    const ends = [0, 0, 0];
    for (let line = 0, at = 0; line < 3; line++) at = ends[line] = answer.indexOf(10, at) + 1;
    const word = (from: number, to: number) => new TextDecoder().decode(answer.subarray(from, to - 1));
    const [status, kind, name] = [word(0, ends[0]), word(ends[0], ends[1]), word(ends[1], ends[2])];
    return { isOk: status.startsWith('2'), kind, name, body: answer.slice(ends[2]) };
}
