// SPDX-License-Identifier: BSL-1.0
// Bundles the page into the header that the library's writer includes: node build.mjs [--check]
// With --check nothing is written: it fails when the committed header is not what these sources give.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { buildSync } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const header = join(here, "../../include/framehex/io/detail/viewer_page.hpp");
const read = (...path) => readFileSync(join(here, ...path), "utf8");

/** Of everything that the header is made from, so that a test can tell without npm that it is up to date. */
function fingerprint() {
  const hash = createHash("sha256");
  const files = [...readdirSync(join(here, "src")).map((name) => `src/${name}`), "build.mjs", "package-lock.json"];
  for (const name of files.sort()) hash.update(`${name}\n${read(name)}`);
  return hash.digest("hex");
}

function bundle(entry) {
  const { outputFiles } = buildSync({
    entryPoints: [join(here, "src", entry)], bundle: true, minify: true, write: false, format: "iife", target: "es2022",
    legalComments: "none", charset: "ascii" });
  return outputFiles[0].text.trim();
}

/** A text as C++ literals in lines of fair length; compilers join them. */
function literals(text) {
  const lines = [];
  for (let i = 0; i < text.length; i += 4000) lines.push(`    ${cpp(text.slice(i, i + 4000))}`);
  return lines.join("\n");
}

// "??" starts a trigraph for some compilers.
const cpp = (text) => JSON.stringify(text).replaceAll("??", '?\\?');

const script = bundle("main.js").replaceAll("</script", "<\\/script");
const notices = `<!-- This page holds three.js, which is under the following licence.\n${read("node_modules/three/LICENSE")}-->\n`;
const fill = (page, mark, text) => page.split(mark).join(text);
let page = fill(read("src/page.html"), "/*style*/", bundle("style.css"));
page = fill(page, "/*script*/", script);
const [head, tail] = page.split("<!--data-->\n");

const text = `// SPDX-License-Identifier: BSL-1.0
#pragma once

// Made by examples/viewer/build.mjs from examples/viewer/src and three.js (MIT; its licence stands in the page). Not to
// be edited. sources: ${fingerprint()}

// As long as it is, every compiler that is supported takes it.
#ifdef __clang__
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Woverlength-strings"
#endif

namespace framehex::detail {

// clang-format off

/// The page that shows a mesh, up to the place of its data.
inline constexpr char viewer_page_head[] =
${literals(fill(head, "<html", `${notices}<html`))};

/// What follows the data.
inline constexpr char viewer_page_tail[] =
${literals(tail)};

// clang-format on

}  // namespace framehex::detail

#ifdef __clang__
#pragma clang diagnostic pop
#endif
`;

if (process.argv.includes("--check")) {
  if (readFileSync(header, "utf8") !== text) {
    console.error("viewer_page.hpp is not what examples/viewer gives: run npm run build there");
    process.exit(1);
  }
} else {
  writeFileSync(header, text);
}
