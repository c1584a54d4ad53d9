/** A line for each test, what failed in full, and the counts alone on the last line. */
import type { FullResult, Reporter, TestCase, TestResult } from "@playwright/test/reporter";

export default class implements Reporter {
  private readonly counts = { passed: 0, failed: 0, skipped: 0 };
  private readonly begun = Date.now();

  onTestEnd(test: TestCase, result: TestResult): void {
    const name = test.titlePath().filter(Boolean).join(" › ");
    const seconds = (result.duration / 1000).toFixed(1);
    if (result.status === "skipped") this.counts.skipped += 1;
    else if (test.ok()) this.counts.passed += 1;
    else this.counts.failed += 1;
    console.log(`${result.status === "skipped" ? "skip" : test.ok() ? "ok  " : "FAIL"} ${seconds.padStart(5)} s  ${name}`);
    for (const { type, description } of test.annotations) console.log(`              ${type}: ${description ?? ""}`);
    if (!test.ok()) for (const error of result.errors) console.log(error.stack ?? error.message ?? String(error.value));
  }

  onError(error: { message?: string; stack?: string }): void {
    this.counts.failed += 1;
    console.log(error.stack ?? error.message);
  }

  onEnd(result: FullResult): void {
    const { passed, failed, skipped } = this.counts;
    // Interrupted or out of time: what did not run has not passed.
    const lost = result.status !== "passed" && failed === 0 ? 1 : 0;
    console.log(`in ${((Date.now() - this.begun) / 1000).toFixed(0)} s`);
    console.log(`${passed} passed, ${failed + lost} failed, ${skipped} skipped`);
  }

  printsToStdio(): boolean {
    return true;
  }
}
