// The path in three dimensions: lines coloured by a quantity, the tool, the remaining heights, axes and views.
import {
    AmbientLight, Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Group, LatheGeometry, LineBasicMaterial,
    LineSegments, Mesh, MeshLambertMaterial, OrthographicCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import { NO_VALUE } from './colors';
import type { ReportData, Solid } from './data';
import type { Run } from './run';
import type { Place } from './measure';
import { axisLine, boxOf, chordsOf, point, Ruler } from './shapes';
import { Stock } from './stock';

export type ViewName = 'iso' | 'XY' | 'XZ' | 'YZ';

/** Directions from the part to the eye. The first is not quite upright, so that Y points up. */
const VIEWS: Record<ViewName, [number, number, number]> = {
    iso: [1, -1, 0.8],
    XY: [0, -1e-4, 1],
    XZ: [0, -1, 0],
    YZ: [1, 0, 0],
};

/** Distance from the pointer within which a path is pointed at, pixels. */
const NEAR = 14;

/** Runs with more segments are drawn one pixel wide, which stays fluid. */
const WIDE_MAX = 60_000;

/** Runs with more segments are drawn one pixel wide while the picture moves. */
const STILL_MAX = 4_000;
/** Runs with more segments are drawn with about as many chords while the picture moves. */
const COARSE_MAX = 15_000;
/** Time without a move after which the whole path is drawn, ms. */
const REST = 200;

const WIDTH = 3;

interface Drawn {
    run: Run;
    group: Group;
    cutting: LineSegments2 | LineSegments;
    /** End points of the segments in `cutting`. */
    segments: Int32Array;
    /** Chords in the place of one or several segments each, while the picture moves. */
    coarse: LineSegments | null;
    /** End points of the chords. */
    chords: Int32Array;
    rapids: LineSegments;
    /** Tools of the run, of which one is seen, and the mark of the tip. */
    tool: Group;
    shapes: Mesh[];
}

export class PathScene {
    private readonly renderer: WebGLRenderer;
    private readonly camera = new OrthographicCamera();
    private readonly scene = new Scene();
    private readonly controls: OrbitControls;
    private readonly drawn: Drawn[];
    private readonly heights: Mesh | null;
    private readonly stockOf: Stock | null;
    private readonly solids: Mesh[];
    private readonly place = point(0x1457d9, 15);
    private readonly ruler = new Ruler();
    private readonly center = new Vector3();
    private readonly low = new Vector3();
    private readonly high = new Vector3();
    /** Box of the stock, or of the solids. */
    private stock: [Vector3, Vector3] = [new Vector3(), new Vector3()];
    private radius = 1;
    /** Half of the width and of the height of the cutting path as seen in the last view. */
    private seen: [number, number] = [1, 1];
    private shown: Run[] = [];
    private isAsked = false;
    /** The picture moves until this timer ends. */
    private rest = 0;

    /** `after` is called after each frame. */
    constructor(private readonly canvas: HTMLCanvasElement, data: ReportData, runs: Run[], private readonly after: () => void) {
        this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
        this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
        this.measure(runs);
        this.drawn = runs.map((run) => this.draw(run, data.tools));
        this.drawn.forEach(({ group }) => this.scene.add(group));
        this.stockOf = data.heights ? new Stock(data.heights, runs[runs.length - 1], data.tools) : null;
        this.heights = data.heights ? this.surface(data.heights) : null;
        if (this.heights) this.scene.add(this.heights);
        if (data.solids.length > 0) this.stock = boxOf(data.solids);
        this.solids = data.solids.map((solid) => this.solid(solid));
        this.solids.forEach((solid) => this.scene.add(solid));
        this.place.visible = false;
        this.scene.add(this.place, this.ruler);
        const light = new DirectionalLight(0xffffff, 2.2);
        light.position.set(0.5, -1, 1.5);
        this.scene.add(light, new AmbientLight(0xffffff, 1.2));
        this.camera.up.set(0, 0, 1);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.addEventListener('change', () => this.move());
        this.show(runs.slice(-1));
        this.view('iso');
        new ResizeObserver(() => this.resize()).observe(canvas.parentElement ?? canvas);
        this.resize();
    }

    /** Looks along an axis, or from a corner, at the whole path. */
    view(name: ViewName): void {
        const direction = new Vector3(...VIEWS[name]).normalize();
        this.controls.target.set(0, 0, 0);
        this.camera.position.copy(direction.multiplyScalar(10 * this.radius));
        // Parallel rays have no eye in front of which all must lie: a large workpiece reaches behind it.
        this.camera.near = -1e3 * this.radius;
        this.camera.far = 1e3 * this.radius;
        this.camera.zoom = 1;
        this.controls.update();
        this.camera.updateMatrixWorld();
        this.frame(name === 'iso' && (this.heights ?? this.solids[0])?.visible ? [[this.low, this.high], this.stock] : [[this.low, this.high]]);
        this.resize();
    }

    /** Shows these runs side by side. */
    show(runs: Run[]): void {
        this.shown = runs;
        this.resize();
    }

    setVisible(what: 'rapids' | 'tool' | 'stock', isVisible: boolean): void {
        this.drawn.forEach((drawn) => {
            if (what === 'rapids') drawn.rapids.visible = isVisible;
            if (what === 'tool') drawn.tool.visible = isVisible;
        });
        if (what === 'stock') [this.heights, ...this.solids].forEach((mesh) => mesh && (mesh.visible = isVisible));
        this.request();
    }

    setBackground(css: string): void {
        this.scene.background = new Color(css);
        this.request();
    }

    /** Colours each segment by its value. */
    paint(run: Run, color: (index: number) => [number, number, number]): void {
        const drawn = this.drawn.find((drawn) => drawn.run === run);
        if (!drawn) return;
        const linear = new Color();
        const colors = (ends: Int32Array) => {
            const colors = new Float32Array(6 * ends.length);
            for (let segment = 0; segment < ends.length; segment++) {
                linear.setRGB(...color(ends[segment]), 'srgb');
                for (const at of [6 * segment, 6 * segment + 3]) [colors[at], colors[at + 1], colors[at + 2]] = [linear.r, linear.g, linear.b];
            }
            return colors;
        };
        const { geometry } = drawn.cutting;
        if (geometry instanceof LineSegmentsGeometry) geometry.setColors(colors(drawn.segments));
        else geometry.setAttribute('color', new BufferAttribute(colors(drawn.segments), 3));
        drawn.coarse?.geometry.setAttribute('color', new BufferAttribute(colors(drawn.chords), 3));
        this.request();
    }

    /** Colours a solid by the values at its vertices. */
    paintSolid(index: number, values: Float64Array, color: (value: number) => [number, number, number]): void {
        const colors = new Float32Array(3 * values.length);
        const linear = new Color();
        values.forEach((value, vertex) => linear.setRGB(...color(value), 'srgb').toArray(colors, 3 * vertex));
        this.solids[index].geometry.setAttribute('color', new BufferAttribute(colors, 3));
        this.request();
    }

    /** Moves the tool of a run; without a direction it stands along Z. */
    moveTool(run: Run, place: [number, number, number], tool = 0, axis: [number, number, number] = [0, 0, 1]): void {
        const drawn = this.drawn.find((drawn) => drawn.run === run);
        if (!drawn) return;
        drawn.tool.position.copy(this.local(...place));
        drawn.tool.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...axis).normalize());
        drawn.shapes.forEach((shape, index) => (shape.visible = index === tool));
        this.move();
    }

    /** Marks a place, or none. */
    mark(place: [number, number, number] | null): void {
        this.place.visible = place !== null;
        if (place) this.place.position.copy(this.local(...place));
        this.request();
    }

    /** Shows the stock at a time of the last run. */
    moveStock(time: number): void {
        if (!this.stockOf || !this.heights) return;
        this.stockOf.moveTo(time);
        this.setHeights(this.heights.geometry, this.stockOf.values);
        this.move();
    }

    /** Shows the places that are measured. */
    rule(places: readonly Place[]): void {
        this.ruler.set(places.map((place) => this.local(...place)));
        this.request();
    }

    /** Place at the pointer: on the path if it is near, otherwise on the stock or part. */
    placeAt(clientX: number, clientY: number): Place | null {
        const found = this.pick(clientX, clientY);
        if (found) return found.run.placeAt(found.time);
        const { px, py, width, height } = this.aim(clientX, clientY);
        const rays = new Raycaster();
        rays.setFromCamera(new Vector2((2 * px) / width - 1, 1 - (2 * py) / height), this.camera);
        // The stock reaches behind the eye (see `view`).
        rays.ray.origin.addScaledVector(rays.ray.direction, this.camera.near);
        const surfaces = [this.heights, ...this.solids].filter((mesh) => mesh !== null).filter((mesh) => mesh.visible);
        const hit = rays.intersectObjects(surfaces, false)[0];
        return hit ? hit.point.add(this.center).toArray() : null;
    }

    /** The picture under the pointer, with the camera set for it, and the place in it, pixels. */
    private aim(clientX: number, clientY: number): { index: number; px: number; py: number; width: number; height: number } {
        const box = this.canvas.getBoundingClientRect();
        const width = box.width / this.shown.length;
        const index = Math.min(Math.floor((clientX - box.left) / width), this.shown.length - 1);
        this.setFrustum(width, box.height);
        return { index, px: clientX - box.left - index * width, py: clientY - box.top, width, height: box.height };
    }

    /** Run and time of the path nearest to the pointer, if it is near. */
    pick(clientX: number, clientY: number): { run: Run; time: number } | null {
        const { index, px, py, width, height } = this.aim(clientX, clientY);
        const drawn = this.drawn.find((drawn) => drawn.run === this.shown[index]);
        if (!drawn) return null;
        const m = this.camera.projectionMatrix.clone().multiply(this.camera.matrixWorldInverse).elements;
        const { run, segments } = drawn;
        const [xs, ys, zs] = run.place;
        const { x: cx, y: cy, z: cz } = this.center;
        const [halfWidth, halfHeight] = [width / 2, height / 2];
        const across = (i: number) => (m[0] * (xs[i] - cx) + m[4] * (ys[i] - cy) + m[8] * (zs[i] - cz) + m[12] + 1) * halfWidth;
        const down = (i: number) => (1 - m[1] * (xs[i] - cx) - m[5] * (ys[i] - cy) - m[9] * (zs[i] - cz) - m[13]) * halfHeight;
        let best = { distance: NEAR, time: NaN };
        let [last, bx, by] = [-1, 0, 0];
        for (const end of segments) {
            const [ax, ay] = last === end - 1 ? [bx, by] : [across(end - 1), down(end - 1)];
            bx = across(end);
            by = down(end);
            last = end;
            const outside = (p: number, a: number, b: number) => p < Math.min(a, b) - NEAR || p > Math.max(a, b) + NEAR;
            if (outside(px, ax, bx) || outside(py, ay, by)) continue;
            const [dx, dy] = [bx - ax, by - ay];
            const square = dx * dx + dy * dy;
            const part = square > 0 ? Math.min(Math.max(((px - ax) * dx + (py - ay) * dy) / square, 0), 1) : 1;
            const distance = Math.hypot(ax + part * dx - px, ay + part * dy - py);
            if (distance < best.distance) {
                // Not quite at the beginning, which belongs to the point before.
                const within = Math.max(part, 1e-3);
                best = { distance, time: run.time[end - 1] + (run.time[end] - run.time[end - 1]) * within };
            }
        }
        return Number.isNaN(best.time) ? null : { run, time: best.time };
    }

    /** Directions of the axes on the screen. */
    axes(): [number, number][] {
        const basis = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
        return basis.map((axis) => {
            const seen = axis.transformDirection(this.camera.matrixWorldInverse);
            return [seen.x, -seen.y];
        });
    }

    /** The next picture is one of many: the whole path is drawn after the last one. */
    private move(): void {
        if (this.drawn.some(({ coarse }) => coarse)) {
            clearTimeout(this.rest);
            this.rest = window.setTimeout(() => {
                this.rest = 0;
                this.request();
            }, REST);
        }
        this.request();
    }

    private request(): void {
        if (this.isAsked) return;
        this.isAsked = true;
        requestAnimationFrame(() => {
            this.isAsked = false;
            this.render();
        });
    }

    /** Draws at once. */
    render(): void {
        const size = this.renderer.getSize(new Vector2());
        const width = size.x / this.shown.length;
        this.renderer.setScissorTest(true);
        this.shown.forEach((run, index) => {
            this.drawn.forEach(({ run: own, group, cutting, coarse }) => {
                group.visible = own === run;
                cutting.visible = !coarse || this.rest === 0;
                if (coarse) coarse.visible = !cutting.visible;
            });
            this.setFrustum(width, size.y);
            this.renderer.setViewport(index * width, 0, width, size.y);
            this.renderer.setScissor(index * width, 0, width, size.y);
            this.renderer.render(this.scene, this.camera);
        });
        this.after();
    }

    private resize(): void {
        const box = (this.canvas.parentElement ?? this.canvas).getBoundingClientRect();
        if (box.width === 0 || box.height === 0) return;
        this.renderer.setSize(box.width, box.height, false);
        for (const { cutting } of this.drawn) {
            if (cutting.material instanceof LineMaterial) cutting.material.resolution.set(box.width / this.shown.length, box.height);
        }
        this.request();
    }

    private setFrustum(width: number, height: number): void {
        const half = 1.15 * Math.max(this.seen[1], (this.seen[0] * height) / width, 1e-2 * this.radius);
        Object.assign(this.camera, { left: (-half * width) / height, right: (half * width) / height, top: half, bottom: -half });
        this.camera.updateProjectionMatrix();
        this.camera.updateMatrixWorld();
    }

    /** Centre and radius of the cutting path; of all moves if none cuts. */
    private measure(runs: Run[]): void {
        for (const counts of [(run: Run, i: number) => i > 0 && run.rapid[i] === 0, () => true]) {
            const low = new Vector3(Infinity, Infinity, Infinity);
            const high = low.clone().negate();
            const point = new Vector3();
            for (const run of runs) {
                for (let i = 0; i < run.points; i++) {
                    if (!counts(run, i)) continue;
                    point.set(run.place[0][i], run.place[1][i], run.place[2][i]);
                    low.min(point);
                    high.max(point);
                }
            }
            if (low.x > high.x) continue;
            this.low.copy(low);
            this.high.copy(high);
            this.center.addVectors(low, high).multiplyScalar(0.5);
            this.radius = Math.max(low.distanceTo(high) / 2, 1e-6);
            return;
        }
    }

    /** Moves the camera across its direction so that these boxes are in the middle, and measures them there. */
    private frame(boxes: [Vector3, Vector3][]): void {
        const seen = new Box3();
        for (const [low, high] of boxes) {
            for (let corner = 0; corner < 8; corner++) {
                const pick = (axis: number) => (corner & (1 << axis) ? high : low).getComponent(axis);
                seen.expandByPoint(this.local(pick(0), pick(1), pick(2)).applyMatrix4(this.camera.matrixWorldInverse));
            }
        }
        const middle = seen.getCenter(new Vector3()).setZ(0).transformDirection(this.camera.matrixWorld);
        const { x, y } = seen.getCenter(new Vector3());
        middle.multiplyScalar(Math.hypot(x, y));
        this.controls.target.add(middle);
        this.camera.position.add(middle);
        this.controls.update();
        this.camera.updateMatrixWorld();
        this.seen = [(seen.max.x - seen.min.x) / 2, (seen.max.y - seen.min.y) / 2];
    }

    private local(x: number, y: number, z: number): Vector3 {
        return new Vector3(x, y, z).sub(this.center);
    }

    private draw(run: Run, outlines: [number, number][][]): Drawn {
        const ends = (rapid: number) => Int32Array.from({ length: run.points }, (_, i) => i).filter((i) => i > 0 && run.rapid[i] === rapid);
        const center = this.center.toArray();
        const positions = (segments: Int32Array, starts: Int32Array = segments.map((end) => end - 1)) => {
            const values = new Float32Array(6 * segments.length);
            for (let segment = 0; segment < segments.length; segment++) {
                for (let k = 0; k < 6; k++) {
                    const axis = k % 3;
                    values[6 * segment + k] = run.place[axis][k < 3 ? starts[segment] : segments[segment]] - center[axis];
                }
            }
            return values;
        };
        const lines = (segments: Int32Array, starts?: Int32Array) =>
            new BufferGeometry().setAttribute('position', new BufferAttribute(positions(segments, starts), 3));
        const group = new Group();
        const segments = ends(0);
        const isWide = segments.length <= WIDE_MAX;
        const cutting = isWide
            ? new LineSegments2(new LineSegmentsGeometry().setPositions(positions(segments)), new LineMaterial({ vertexColors: true, linewidth: WIDTH }))
            : new LineSegments(lines(segments), new LineBasicMaterial({ vertexColors: true }));
        const [starts, chords] = segments.length > STILL_MAX ? chordsOf(segments, COARSE_MAX) : [new Int32Array(), new Int32Array()];
        const coarse = chords.length > 0 ? new LineSegments(lines(chords, starts), new LineBasicMaterial({ vertexColors: true })) : null;
        if (coarse) {
            coarse.frustumCulled = false;
            group.add(coarse);
        }
        const rapids = new LineSegments(lines(ends(1)), new LineBasicMaterial({ color: new Color(...NO_VALUE), transparent: true, opacity: 0.5 }));
        const tool = new Group();
        const material = new MeshLambertMaterial({ color: 0xd8a33a, transparent: true, opacity: 0.4, side: DoubleSide, depthWrite: false });
        const shapes = outlines.map((outline) => {
            const closed = [...outline, ...outline.slice(0, 1)].map(([radius, height]) => new Vector2(radius, height));
            return new Mesh(new LatheGeometry(closed, 48).rotateX(Math.PI / 2), material);
        });
        shapes.forEach((shape) => tool.add(shape));
        const top = outlines.flat().reduce((most, [, height]) => Math.max(most, height), 0);
        if (run.axis && top > 0) tool.add(axisLine(1.5 * top));
        tool.add(point(0xe0301e, 11));
        [cutting, rapids, tool].forEach((object) => {
            object.frustumCulled = false;
            group.add(object);
        });
        return { run, group, cutting, segments, coarse, chords, rapids, tool, shapes };
    }

    /** Surface through the middles of the cells; it is seen from the first `moveStock` on. */
    private surface({ columns, lowest, step, values }: NonNullable<ReportData['heights']>): Mesh {
        const rows = values.length / columns;
        const [bottom, top] = this.stockOf?.range() ?? [0, 0];
        this.stock[0].set(lowest[0], lowest[1], Math.min(bottom, this.low.z));
        this.stock[1].set(lowest[0] + columns * step, lowest[1] + rows * step, Math.max(top, this.low.z));
        const positions = new Float32Array(3 * values.length);
        for (let cell = 0; cell < values.length; cell++) {
            const [x, y] = [lowest[0] + (cell % columns + 0.5) * step, lowest[1] + (Math.floor(cell / columns) + 0.5) * step];
            this.local(x, y, 0).toArray(positions, 3 * cell);
        }
        const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(positions, 3));
        geometry.setIndex(new BufferAttribute(new Uint32Array(6 * Math.max(rows - 1, 0) * Math.max(columns - 1, 0)), 1));
        geometry.userData = { columns, rows };
        // The path runs in and behind the material, and stays visible.
        const glass = { transparent: true, opacity: 0.45, depthWrite: false };
        const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: 0x8ea3ba, side: DoubleSide, ...glass }));
        mesh.frustumCulled = false;
        return mesh;
    }

    /** Heights of the surface; it has holes where nothing is left. */
    private setHeights(geometry: BufferGeometry, values: Float64Array): void {
        const { columns, rows } = geometry.userData;
        const [positions, index] = [geometry.getAttribute('position').array, geometry.getIndex()];
        if (!index) return;
        for (let cell = 0; cell < values.length; cell++) positions[3 * cell + 2] = (values[cell] || 0) - this.center.z;
        let used = 0;
        for (let row = 0; row + 1 < rows; row++) {
            for (let column = 0; column + 1 < columns; column++) {
                const a = row * columns + column;
                const [b, c, d] = [a + 1, a + columns, a + columns + 1];
                if (Number.isNaN(values[a] + values[b] + values[c] + values[d])) continue;
                index.array.set([a, b, c, b, d, c], used);
                used += 6;
            }
        }
        index.array.fill(0, used);
        index.needsUpdate = true;
        geometry.getAttribute('position').needsUpdate = true;
        geometry.computeVertexNormals();
        // Measured again when a place on it is looked for.
        geometry.boundingSphere = null;
    }

    private solid({ x, y, z, corners, values }: Solid): Mesh {
        const positions = new Float32Array(3 * x.length);
        for (let vertex = 0; vertex < x.length; vertex++) this.local(x[vertex], y[vertex], z[vertex]).toArray(positions, 3 * vertex);
        const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(positions, 3));
        geometry.setIndex(new BufferAttribute(Uint32Array.from(corners), 1));
        geometry.computeVertexNormals();
        const glass = { transparent: true, opacity: 0.55, depthWrite: false };
        // Colours that have a meaning are not mixed with those behind them.
        const look = values.length > 0 ? { color: 0xffffff, vertexColors: true } : { color: 0x8ea3ba, ...glass };
        return new Mesh(geometry, new MeshLambertMaterial({ side: DoubleSide, ...look }));
    }
}
