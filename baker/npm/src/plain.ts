/** What a command printed about an error, as a sentence. */
export function plain(text: string): string {
  return text
    .replace(/^(rebounce|error): /, "")
    .split("\n\nUsage:")[0]!
    .trim();
}
