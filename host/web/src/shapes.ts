// Parts of the picture: chords of a path, boxes, marks and lines.
import { Box3, BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, LineSegments, Points, PointsMaterial, Vector3 } from 'three';
import type { Solid } from './data';

/** Colour of what is measured. */
const RULER = 0x1457d9;

/** Begins and ends of about so many chords, each over segments that follow each other. */
export function chordsOf(segments: Int32Array, most: number): [Int32Array, Int32Array] {
    const each = Math.ceil(segments.length / most);
    const [starts, chords]: [number[], number[]] = [[], []];
    for (let index = 0, count = 0; index < segments.length; index++, count++) {
        const end = segments[index];
        if (count === 0 || count >= each || end - 1 !== segments[index - 1]) {
            starts.push(end - 1);
            chords.push(end);
            count = 0;
        } else {
            chords[chords.length - 1] = end;
        }
    }
    return [Int32Array.from(starts), Int32Array.from(chords)];
}

/** Lowest and highest corner. */
export function boxOf(solids: Solid[]): [Vector3, Vector3] {
    const box = new Box3();
    const point = new Vector3();
    for (const { x, y, z } of solids) {
        for (let vertex = 0; vertex < x.length; vertex++) box.expandByPoint(point.set(x[vertex], y[vertex], z[vertex]));
    }
    return [box.min, box.max];
}

/** Point that is always seen. */
export function point(color: number, size: number): Points {
    const place = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(3), 3));
    const mark = new Points(place, new PointsMaterial({ color, size, sizeAttenuation: false, depthTest: false, transparent: true }));
    // Above the tool, which is drawn among the transparent objects too.
    mark.renderOrder = 1;
    mark.frustumCulled = false;
    return mark;
}

/** The tool's axis from the tip upwards. */
export function axisLine(length: number): LineSegments {
    const ends = new BufferAttribute(new Float32Array([0, 0, 0, 0, 0, length]), 3);
    const line = new LineSegments(new BufferGeometry().setAttribute('position', ends), new LineBasicMaterial({ color: 0xe0301e }));
    line.frustumCulled = false;
    return line;
}

/** Marks at two places and the line between them, always seen. */
export class Ruler extends Group {
    private readonly marks = [point(RULER, 11), point(RULER, 11)];
    private readonly line = new Line(new BufferGeometry(), new LineBasicMaterial({ color: RULER, depthTest: false, transparent: true }));

    constructor() {
        super();
        this.line.renderOrder = 1;
        this.line.frustumCulled = false;
        this.add(this.line, ...this.marks);
        this.set([]);
    }

    /** Shows none, one or two places. */
    set(places: Vector3[]): void {
        this.marks.forEach((mark, index) => {
            mark.visible = index < places.length;
            if (mark.visible) mark.position.copy(places[index]);
        });
        this.line.visible = places.length === 2;
        if (this.line.visible) this.line.geometry.setFromPoints(places);
    }
}
