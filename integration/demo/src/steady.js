// Decides whether a measured time is steady enough to show. During the first frames, programs are compiled, and if
// other programs use the device too, the times vary.

const COUNT = 5; // number of last times that are compared
const SPREAD = 0.15; // largest difference between them, as a fraction of their median

const sorted = (times) => times.slice(-COUNT).sort((a, b) => a - b);

// Returns the median of the last five times.
export const median = (times) => sorted(times)[COUNT >> 1];

// Returns whether the last five times differ by at most 15 % of their median.
export function steady(times) {
  const last = sorted(times);
  return last.length === COUNT && last.at(-1) - last[0] <= SPREAD * last[COUNT >> 1];
}
