/** How pictures of one shape are laid out in a place. */

export interface Size {
  width: number;
  height: number;
}

/** Room for a name above a picture. */
const NAME = 20;
const GAP = 8;

/** Columns and cell size for `count` pictures of an aspect, as large as can be; `foot` is what each needs below it. */
export function grid(count: number, { width, height }: Size, aspect: number, foot = 0): { columns: number; cell: Size } {
  const name = count > 1 ? NAME : 0;
  let best = { columns: 1, cell: { width: 0, height: 0 } };
  for (let columns = 1; columns <= Math.max(1, count); columns += 1) {
    const rows = Math.ceil(count / columns);
    const w = (width - GAP * (columns + 1)) / columns;
    const h = (height - GAP * (rows + 1)) / rows - name - foot;
    const cell = { width: Math.floor(Math.min(w, h * aspect)), height: Math.floor(Math.min(w, h * aspect) / aspect) };
    if (cell.width > best.cell.width) best = { columns, cell };
  }
  return best;
}
