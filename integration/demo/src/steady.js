// Whether a time is worth telling: the first frames compile, and a device that other programs use too gives any number.

const COUNT = 5; // the last times that are looked at
const SPREAD = 0.15; // of their median, at the most

const sorted = (times) => times.slice(-COUNT).sort((a, b) => a - b);

// Of the last five times
export const median = (times) => sorted(times)[COUNT >> 1];

// Whether the last five lie within 15 % of their median
export function steady(times) {
  const last = sorted(times);
  return last.length === COUNT && last.at(-1) - last[0] <= SPREAD * last[COUNT >> 1];
}
