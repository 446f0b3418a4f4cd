// Distance between two places.

export type Place = [number, number, number];

/** Two places, one after the other; a third one begins anew. */
export class Measure {
    private taken: Place[] = [];

    get places(): readonly Place[] {
        return this.taken;
    }

    take(place: Place): void {
        this.taken = this.taken.length === 1 ? [this.taken[0], place] : [place];
    }

    /** The places, and what lies between them, in a unit. */
    text(unit: string): string {
        const digits = unit === 'in' ? 4 : 3;
        const number = (value: number) => value.toFixed(digits).replace(/^-(0\.0+)$/, '$1');
        const axes = (place: Place, sign = '') => ['X', 'Y', 'Z'].map((axis, index) => `${sign}${axis} ${number(place[index])}`).join(', ');
        const [from, to] = this.taken;
        if (!from) return 'Measure: click the first place, on the path or the stock; Enter takes the tip of the tool.';
        if (!to) return `From ${axes(from)} ${unit}. Click the second place.`;
        const way = to.map((value, axis) => value - from[axis]) as Place;
        return `Distance ${number(Math.hypot(...way))} ${unit}: ${axes(way, 'd')}; from ${axes(from)} to ${axes(to)}`;
    }
}
