"""What tests share: samples of scenes and logs, independent checkers, pages and processes."""
