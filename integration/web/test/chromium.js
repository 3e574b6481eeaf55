// Starts headless Chromium for the tests of this folder and of the live page (../../demo/test). It draws on Chromium's
// own software devices, and makes no request to any network.

// The same flags as in validation/bokeh_validation/browser/__init__.py
const FLAGS = [
  ...['--disable-background-networking', '--disable-component-update', '--disable-domain-reliability', '--disable-sync'],
  ...['--disable-breakpad', '--disable-quic', '--no-first-run', '--no-pings', '--metrics-recording-only'],
  ...['--disable-gpu-watchdog', '--disable-background-timer-throttling', '--enable-unsafe-webgpu'],
  ...['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--use-webgpu-adapter=swiftshader'],
  '--host-resolver-rules=MAP * ~NOTFOUND',
];

// Starts Chromium, and returns Playwright's browser. `chromium` is an export of playwright-core. BOKEH_CHROMIUM is the
// path of the program.
export function launched(chromium, flags = []) {
  return chromium.launch({
    executablePath: process.env.BOKEH_CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    chromiumSandbox: process.getuid?.() !== 0, // as root, it does not start with a sandbox
    args: [...FLAGS, ...flags],
  });
}

// Returns a list to which the errors are added that a page throws or writes to the console from now on.
export function errorsOf(page) {
  const said = [];
  page.on('console', (message) => message.type() === 'error' && said.push(message.text()));
  page.on('pageerror', (error) => said.push(error.message));
  return said;
}
