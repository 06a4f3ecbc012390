// Does nothing, to measure the start of a process.
int main() {}
