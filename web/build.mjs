// Bundles the page into dist/: index.html, a script and a style named by their content, licences.
import { build } from "esbuild";
import { mkdir, readFile, readdir, rm, writeFile } from "node:fs/promises";
import path from "node:path";

const OUT = "dist";
await rm(OUT, { recursive: true, force: true });
await mkdir(OUT, { recursive: true });

const { metafile } = await build({
  entryPoints: { app: "src/main.ts", style: "src/style.css" },
  entryNames: "[name]-[hash]",
  outdir: OUT,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "eof",
  metafile: true,
  logLevel: "warning",
});

// The viewer of one plan: a document that holds its own script and style.
const viewer = await build({
  entryPoints: { script: "src/embed.ts", style: "src/embed.css" },
  outdir: "embed",
  write: false,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none", // licenses.txt has them
  logLevel: "warning",
});
const inlined = (suffix) => viewer.outputFiles.find((file) => file.path.endsWith(suffix)).text;
const shell = await readFile("embed.html", "utf8");
await writeFile(
  `${OUT}/embed.html`,
  // Functions, since "$" means something in a text that replaces.
  shell.replace("%STYLE%", () => inlined(".css"))
    .replace("%SCRIPT%", () => inlined(".js").replaceAll("</script", "<\\/script")),
);

const made = Object.keys(metafile.outputs).map((file) => path.basename(file));
const part = (suffix) => `page/${made.find((file) => file.endsWith(suffix))}`;
const page = await readFile("index.html", "utf8");
await writeFile(
  `${OUT}/index.html`,
  page.replace("%STYLE%", part(".css")).replace("%SCRIPT%", part(".js")),
);

// The licences of what is in the bundle go with it.
const packages = new Set();
for (const file of Object.keys(metafile.inputs)) {
  const match = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(file);
  if (match) packages.add(match[1]);
}
const notices = [];
for (const name of [...packages].sort()) {
  const folder = `node_modules/${name}`;
  const { version, license } = JSON.parse(await readFile(`${folder}/package.json`, "utf8"));
  const file = (await readdir(folder)).find((f) => /^licen[cs]e/i.test(f));
  // A package may name the Apache licence without holding it; TypeScript's copy is the same text.
  const apache = license === "Apache-2.0" ? "node_modules/typescript/LICENSE" : null;
  const source = file ? `${folder}/${file}` : apache;
  if (source === null) throw new Error(`${name} has no licence file`);
  const text = await readFile(source, "utf8");
  notices.push(`${name} ${version}\n\n${text.trim()}\n`);
}
await writeFile(`${OUT}/licenses.txt`, notices.join(`\n${"-".repeat(80)}\n\n`));
