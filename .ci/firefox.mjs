// Opens pages of `mechanim report` in Firefox as a reader does: from a disk, without a network.
//
//     node .ci/firefox.mjs FIREFOX PROGRAM FOLDER SCENES [ENGINE]
//
// Every page is silent, asks for nothing but itself, and its slider moves. With an engine, live pages too: their tables and
// pictures are those of the program, sliders, pulled links and assemblies move the mechanism, and the article is made anew.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

const [firefox, program, folder, names, engine] = process.argv.slice(2);
const scenes = names.split(",");
const REPORT = "window.reports[0]";
const require = createRequire(import.meta.url);
const unpacking = require(path.resolve("src/page/web/unpack.js"));
const { assembled } = require(path.resolve("src/page/web/assemble.js"));

function run(...words) {
  try {
    return execFileSync(program, [...words, "--quiet"], { maxBuffer: 1 << 28 });
  } catch (error) {
    // A check that does not pass writes its page all the same.
    return error.stdout;
  }
}

/** Waits until an expression is true in a page. */
async function until(page, expression, what) {
  for (let k = 0; k < 600; k += 1) {
    if (await page.evaluate(expression)) return;
    await new Promise((resolve) => { setTimeout(resolve, 100); });
  }
  assert.fail(`${page.url()}: ${what}`);
}

async function open(browser, file) {
  const page = await browser.newPage();
  const address = pathToFileURL(file).href;
  const faults = [];
  await page.setViewport({ width: 1200, height: 900 });
  page.on("console", (told) => { if (["error", "warn"].includes(told.type())) faults.push(told.text()); });
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("request", (request) => {
    const asked = request.url();
    if (asked !== address && !/^(data|blob):/.test(asked)) faults.push(`asked for ${asked}`);
  });
  await page.goto(address);
  return { page, close: async () => {
    await page.close();
    // What a browser without a graphics card says of WebGL is no fault of the page.
    const own = faults.filter((text) => !/WebGL/.test(text));
    assert.deepEqual(own, [], address);
  } };
}

async function judgePage(browser, scene) {
  const file = path.join(folder, `${scene}-firefox.html`);
  run("report", scene, "--out", file);
  const { page, close } = await open(browser, file);
  const last = await page.evaluate(`${REPORT}.data.times.length - 1`);
  if (last > 0) {
    await page.focus("[data-part=slider]");
    await page.keyboard.press("End");
    assert.equal(await page.evaluate(`${REPORT}.frame`), last, scene);
  }
  await close();
}

/** The bytes that the engine answers with. */
async function bytesOf(page, question) {
  const text = await page.evaluate(`${REPORT}.live.ask(${JSON.stringify(question)}).then((bytes) => {
    let s = "";
    for (const b of bytes) s += String.fromCharCode(b);
    return btoa(s);
  })`);
  return Buffer.from(text, "base64");
}

async function judgeLivePage(browser, scene) {
  const file = path.join(folder, `${scene}-firefox-live.html`);
  run("report", scene, "--live", "--wasm", engine, "--out", file);
  const [, held] = readFileSync(file, "utf8").match(/ id="engine">([^<]*)</);
  const whole = assembled(unpacking.unpacked(unpacking.bytesOf(held)));
  assert.ok(readFileSync(engine).equals(Buffer.from(whole)), `${scene}: the engine in the page is another`);
  const { page, close } = await open(browser, file);
  const live = `${REPORT}.live`;
  const settled = `${live} && !${live}.isBusy && ${live}.isJudged && !${live}.sections.inert`;
  await until(page, `${live} !== null && ${live}.sliders.length + ${live}.hand.length > 0`, "the engine does not start");
  await until(page, settled, "the article is not made");
  assert.equal((await bytesOf(page, { ask: "csv" })).toString(), run("solve", scene, "--out", "-").toString(), `${scene}: another table`);
  const picture = path.join(folder, "firefox-frame.png");
  run("render", scene, "--renderer", "cpu", "--frame", "0", "--out", picture);
  assert.ok((await bytesOf(page, { ask: "png", time: 0 })).equals(readFileSync(picture)), `${scene}: another picture`);
  if (await page.evaluate(`${live}.sliders.length > 0`)) {
    await page.focus("[data-part=bench] input[type=range]");
    await page.keyboard.press("ArrowRight");
    await until(page, settled, "the article is not made after a move");
    // Where the way ends at once the slider stays, and the page says why.
    assert.ok(await page.evaluate(`${live}.parameters.size > 0 || !${live}.told.hidden`), `${scene}: nothing moved`);
  }
  await page.evaluate(`${live}.findAssemblies()`);
  await until(page, `!${live}.assemblies.hidden`, "no assemblies are listed");
  await close();
}

const browser = await puppeteer.launch({
  browser: "firefox",
  executablePath: firefox,
  headless: true,
  extraPrefsFirefox: { "webgl.force-enabled": true },
});
try {
  console.log(`Firefox: ${await browser.version()}`);
  for (const scene of scenes) {
    await judgePage(browser, scene);
    if (engine) await judgeLivePage(browser, scene);
    console.log(`page ${scene} in Firefox: ok`);
  }
} finally {
  await browser.close();
}
