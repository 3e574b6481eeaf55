// Headless Chromium as the tests of this folder and of the live page (../../demo/test) start it: on its own software
// devices, and asking nothing of any network.

// As in validation/bokeh_validation/browser/__init__.py
const FLAGS = [
  ...['--disable-background-networking', '--disable-component-update', '--disable-domain-reliability', '--disable-sync'],
  ...['--disable-breakpad', '--disable-quic', '--no-first-run', '--no-pings', '--metrics-recording-only'],
  ...['--disable-gpu-watchdog', '--disable-background-timer-throttling', '--enable-unsafe-webgpu'],
  ...['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--use-webgpu-adapter=swiftshader'],
  '--host-resolver-rules=MAP * ~NOTFOUND',
];

// Start it. `chromium` is playwright-core's; BOKEH_CHROMIUM names the program. Returns Playwright's browser.
export function launched(chromium, flags = []) {
  return chromium.launch({
    executablePath: process.env.BOKEH_CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    chromiumSandbox: process.getuid?.() !== 0, // it refuses to start with a sandbox as root
    args: [...FLAGS, ...flags],
  });
}

// Errors that a page throws or writes to the console from now on, as a list that grows.
export function errorsOf(page) {
  const said = [];
  page.on('console', (message) => message.type() === 'error' && said.push(message.text()));
  page.on('pageerror', (error) => said.push(error.message));
  return said;
}
