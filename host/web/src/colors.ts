// Colour scales that keep their order for colour-blind eyes and in grey, as published with matplotlib, in ten stops.

const STOPS = {
    cividis: '00224e 123570 3b496c 575d6d 707173 8a8678 a59c74 c3b369 e1cc55 fee838',
    viridis: '440154 482878 3e4989 31688e 26828e 1f9e89 35b779 6ece58 b5de2b fde725',
};

/** Diverging scale about the target, for colour-blind eyes: RdYlBu of ColorBrewer, its middle darkened to be seen on light and dark ground. */
const DIVERGING = '313695 4575b4 74add1 8fb8b8 9a9a86 d9a25f f46d43 d73027 a50026';

/** Names of scales of one direction. */
export type ScaleName = keyof typeof STOPS;

/** Quantities whose right value is 1. */
export const IS_RATIO = new Set(['chip', 'contour', 'ratio']);

/** Part of the diverging scale, 1 in its middle: equal factors up and down are equally far. */
export function aboutOne(value: number, [low, high]: [number, number]): number {
    const span = Math.max(Math.log(high), -Math.log(Math.max(low, 1e-3)), Math.log(1.1));
    return value > 0 ? 0.5 + Math.log(value) / (2 * span) : value === 0 ? 0 : NaN;
}

/** Value at a part of the diverging scale. */
export function valueAbout([low, high]: [number, number], part: number): number {
    const span = Math.max(Math.log(high), -Math.log(Math.max(low, 1e-3)), Math.log(1.1));
    return Math.exp((2 * part - 1) * span);
}

/** Colour of moves without a value. */
export const NO_VALUE: [number, number, number] = [0.55, 0.55, 0.58];

export class Scale {
    private readonly stops: [number, number, number][];

    constructor(name: ScaleName | 'diverging') {
        this.stops = (name === 'diverging' ? DIVERGING : STOPS[name]).split(' ').map((hex) => {
            const value = parseInt(hex, 16);
            return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
        });
    }

    /** Colour of a part from 0 to 1, sRGB. */
    color(part: number): [number, number, number] {
        if (Number.isNaN(part)) return NO_VALUE;
        const place = Math.min(Math.max(part, 0), 1) * (this.stops.length - 1);
        const index = Math.min(Math.floor(place), this.stops.length - 2);
        const [a, b, within] = [this.stops[index], this.stops[index + 1], place - index];
        return [0, 1, 2].map((c) => a[c] + (b[c] - a[c]) * within) as [number, number, number];
    }

    /** The scale as a CSS gradient to the right. */
    gradient(): string {
        const css = this.stops.map((stop) => `rgb(${stop.map((c) => Math.round(255 * c)).join(' ')})`);
        return `linear-gradient(to right, ${css.join(', ')})`;
    }
}

/** Number for a person: four digits. */
export function written(value: number): string {
    if (Number.isNaN(value)) return '–';
    if (value === 0) return '0';
    const digits = Math.min(Math.max(3 - Math.floor(Math.log10(Math.abs(value))), 0), 6);
    return value.toFixed(digits);
}
